# OpenGL loader, generated at build by glad 2. --mx: one table of functions a context and no globals. --reproducible: never downloads.
set(BURRHOLE_GLAD_PYTHON /usr/bin/python3 CACHE FILEPATH "Python that has the glad 2 module (Debian: python3-glad)")

# bh_glad_objects(NAME): object library with gl.c and its include folder; linked into the one target that knows OpenGL.
function(bh_glad_objects name)
  set(out "${CMAKE_CURRENT_BINARY_DIR}/glad")
  add_custom_command(
    OUTPUT "${out}/src/gl.c" "${out}/include/glad/gl.h" "${out}/include/KHR/khrplatform.h"
    COMMAND "${BURRHOLE_GLAD_PYTHON}" -m glad --quiet --reproducible --extensions= --api gl:core=4.5 --out-path "${out}" c --mx
    COMMENT "Generating the OpenGL 4.5 core loader (glad 2)"
    VERBATIM)
  add_library(${name} OBJECT "${out}/src/gl.c" "${out}/include/glad/gl.h")
  target_include_directories(${name} SYSTEM PUBLIC "${out}/include")
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endfunction()
