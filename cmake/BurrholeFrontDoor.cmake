# What the built program says about itself, for man and for shells: printed by it once it is built, installed where Debian looks.
if(NOT TARGET burrhole OR (CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR))
  return()
endif()

set(burrhole_front "${PROJECT_BINARY_DIR}/front")
file(GLOB burrhole_shipped CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/app/scenes/*.toml" "${PROJECT_SOURCE_DIR}/app/tools/*.toml")

# bh_print(FILE FOLDER ARGUMENTS...): FILE is what `burrhole ARGUMENTS` prints, installed into FOLDER.
set(burrhole_printed "")
function(bh_print file folder)
  string(JOIN " " command ${ARGN})
  get_filename_component(place "${burrhole_front}/${file}" DIRECTORY)
  file(MAKE_DIRECTORY "${place}")
  # Whole or not at all: a program that fails leaves the old file and ends the build.
  add_custom_command(OUTPUT "${burrhole_front}/${file}"
    COMMAND burrhole ${ARGN} > "${burrhole_front}/${file}.tmp"
    COMMAND ${CMAKE_COMMAND} -E rename "${burrhole_front}/${file}.tmp" "${burrhole_front}/${file}"
    DEPENDS burrhole ${burrhole_shipped} COMMENT "burrhole ${command}" VERBATIM)
  install(FILES "${burrhole_front}/${file}" DESTINATION "${folder}")
  set(burrhole_printed ${burrhole_printed} "${burrhole_front}/${file}" PARENT_SCOPE)
endfunction()

bh_print(burrhole.1 "${CMAKE_INSTALL_MANDIR}/man1" man)
bh_print(bash/burrhole "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" completion bash)
bh_print(zsh/_burrhole "${CMAKE_INSTALL_DATADIR}/zsh/site-functions" completion zsh)
bh_print(fish/burrhole.fish "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d" completion fish)
add_custom_target(burrhole_front_door ALL DEPENDS ${burrhole_printed})
