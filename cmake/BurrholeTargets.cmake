# Shared properties of every target of ours: language, warnings, exactness, sanitizers.

set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
add_library(burrhole_options INTERFACE)
add_library(burrhole::options ALIAS burrhole_options)
target_compile_features(burrhole_options INTERFACE cxx_std_20)
# -ffp-contract=off: the same bits whether or not the machine has fused multiply-add.
target_compile_options(burrhole_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Wold-style-cast -ffp-contract=off)
if(BURRHOLE_SANITIZE STREQUAL "address")
  target_compile_options(burrhole_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(burrhole_options INTERFACE -fsanitize=address,undefined)
elseif(BURRHOLE_SANITIZE STREQUAL "thread")
  target_compile_options(burrhole_options INTERFACE -fsanitize=thread)
  target_link_options(burrhole_options INTERFACE -fsanitize=thread)
elseif(BURRHOLE_SANITIZE)
  message(FATAL_ERROR "BURRHOLE_SANITIZE must be address, thread or empty, not '${BURRHOLE_SANITIZE}'")
endif()

# bh_add_library(NAME): static library burrhole_NAME with alias burrhole::NAME; sources come by target_sources.
function(bh_add_library name)
  add_library(burrhole_${name} STATIC)
  add_library(burrhole::${name} ALIAS burrhole_${name})
  set_target_properties(burrhole_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(burrhole_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/burrhole>)
  target_link_libraries(burrhole_${name} PRIVATE $<BUILD_INTERFACE:burrhole::options>)
  target_compile_features(burrhole_${name} PUBLIC cxx_std_20)
endfunction()

# bh_heavy_sources(TARGET FILES...): files that instantiate OpenVDB grids; UBSan on them costs half a minute a file, so it is off there.
function(bh_heavy_sources target)
  target_sources(${target} PRIVATE ${ARGN})
  if(BURRHOLE_SANITIZE STREQUAL "address")
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "-fno-sanitize=undefined")
  endif()
endfunction()
