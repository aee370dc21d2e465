# Shared properties of every target of ours: language, warnings, exactness, sanitizers.

set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(bh_glm_definitions GLM_FORCE_SIZE_T_LENGTH GLM_FORCE_XYZW_ONLY)
add_library(burrhole_options INTERFACE)
add_library(burrhole::options ALIAS burrhole_options)
target_compile_features(burrhole_options INTERFACE cxx_std_20)
# -ffp-contract=off: the same bits whether or not the machine has fused multiply-add.
target_compile_options(burrhole_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Wold-style-cast -ffp-contract=off)
# GCC 12 warns of overlapping copies inside std::string at -O3, wrongly [GCC bug 105651].
target_compile_options(burrhole_options INTERFACE
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>)
# A hundred programs are linked: lld needs a quarter of the time.
find_program(LLD ld.lld)
if(LLD)
  target_link_options(burrhole_options INTERFACE -fuse-ld=lld)
endif()
target_compile_options(burrhole_options INTERFACE -ffile-prefix-map=${PROJECT_SOURCE_DIR}/=)
if(BURRHOLE_SANITIZE STREQUAL "address")
  # Five checks are left out: four of them repeat what a trapped address shows, and together they double the time to compile.
  target_compile_options(burrhole_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
    -fno-sanitize=null,nonnull-attribute,returns-nonnull-attribute,object-size,vptr)
  target_link_options(burrhole_options INTERFACE -fsanitize=address,undefined)
elseif(BURRHOLE_SANITIZE STREQUAL "thread")
  target_compile_options(burrhole_options INTERFACE -fsanitize=thread)
  target_link_options(burrhole_options INTERFACE -fsanitize=thread)
elseif(BURRHOLE_SANITIZE)
  message(FATAL_ERROR "BURRHOLE_SANITIZE must be address, thread or empty, not '${BURRHOLE_SANITIZE}'")
endif()

# What most files read, parsed once. Off where a build must show that each file names what it uses (release, fuzz).
option(BURRHOLE_PRECOMPILED_HEADERS "Parse the headers that most files read once" OFF)
set(bh_common_headers
  <algorithm> <array> <atomic> <bit> <cmath> <cstdint> <cstdlib> <cstring> <filesystem> <fstream> <functional> <limits> <map> <memory>
  <numbers> <numeric> <optional> <set> <span> <string> <string_view> <tuple> <utility> <variant> <vector>
  <fmt/format.h> <glm/glm.hpp> <glm/gtc/quaternion.hpp>)

# bh_precompile_headers(NAME HEADERS...): an object library that holds them, for bh_reuse_headers.
function(bh_precompile_headers name)
  if(BURRHOLE_PRECOMPILED_HEADERS)
    file(WRITE "${PROJECT_BINARY_DIR}/${name}.cpp.new" "// Holds the precompiled headers.\n")
    file(COPY_FILE "${PROJECT_BINARY_DIR}/${name}.cpp.new" "${PROJECT_BINARY_DIR}/${name}.cpp" ONLY_IF_DIFFERENT)
    add_library(${name} OBJECT "${PROJECT_BINARY_DIR}/${name}.cpp")
    target_compile_definitions(${name} PRIVATE ${bh_glm_definitions})
    target_link_libraries(${name} PRIVATE burrhole::options glm::glm fmt::fmt)
    target_precompile_headers(${name} PRIVATE ${ARGN})
    set_target_properties(${name} PROPERTIES CXX_COMPILER_LAUNCHER
      "${PROJECT_SOURCE_DIR}/cmake/fresh_header.sh;${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${name}.dir/cmake_pch.hxx.gch;${CMAKE_CXX_COMPILER_LAUNCHER}")
  endif()
endfunction()

# bh_reuse_headers(TARGET NAME): TARGET reads the headers of NAME.
function(bh_reuse_headers target name)
  if(BURRHOLE_PRECOMPILED_HEADERS)
    # Macros that the headers look at must be the same in both.
    target_compile_definitions(${target} PRIVATE ${bh_glm_definitions} $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
    target_precompile_headers(${target} REUSE_FROM ${name})
    # GCC 12 forgets there that a header is the system's and reports its own false alarms in <string>.
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread)
    # ccache preprocesses first, and must see there which precompiled header was read.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
  endif()
endfunction()

# bh_add_library(NAME): static library burrhole_NAME with alias burrhole::NAME; sources come by target_sources.
function(bh_add_library name)
  add_library(burrhole_${name} STATIC)
  add_library(burrhole::${name} ALIAS burrhole_${name})
  set_target_properties(burrhole_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(burrhole_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/burrhole>)
  target_link_libraries(burrhole_${name} PRIVATE $<BUILD_INTERFACE:burrhole::options>)
  target_compile_features(burrhole_${name} PUBLIC cxx_std_20)
  bh_reuse_headers(burrhole_${name} burrhole_library_headers)
endfunction()

# bh_heavy_sources(TARGET GRIDS|KERNELS FILES...): what takes minutes to compile with all that the sanitizers watch. Without UBSan: GRIDS, which
# instantiate OpenVDB. Without ASan's watch on the lifetime of temporaries, all else watched: both, as vectors inlined are temporaries by the thousand.
function(bh_heavy_sources target kind)
  target_sources(${target} PRIVATE ${ARGN})
  if(BURRHOLE_SANITIZE STREQUAL "address")
    set(options -fno-sanitize-address-use-after-scope)
    if(kind STREQUAL "GRIDS")
      list(APPEND options -fno-sanitize=undefined)
    endif()
    list(TRANSFORM ARGN PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/")
    set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target}
      PROPERTIES COMPILE_OPTIONS "${options}" SKIP_PRECOMPILE_HEADERS ON)
  endif()
endfunction()
