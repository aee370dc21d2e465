# Shaders: expanded, validated and embedded at build. Also a script: cmake -DFOLDER=... -DVALIDATOR=... -P BurrholeShaders.cmake validates.
if(CMAKE_SCRIPT_MODE_FILE)
  file(GLOB vertex_shaders "${FOLDER}/*.vert")
  if(NOT vertex_shaders)
    message(FATAL_ERROR "no shader variant in ${FOLDER}")
  endif()
  foreach(vertex IN LISTS vertex_shaders)
    string(REGEX REPLACE "[.]vert$" ".frag" fragment "${vertex}")
    execute_process(COMMAND "${VALIDATOR}" -l "${vertex}" "${fragment}" RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
    if(failed)
      message(FATAL_ERROR "${said}")
    endif()
  endforeach()
  return()
endif()

find_program(GLSLANG_VALIDATOR glslangValidator REQUIRED)
set(BURRHOLE_SHADERS_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")

# bh_embed_shaders(TARGET TOOL FOLDER): TOOL writes every variant as the driver will see it and a C++ file of the sources, which joins TARGET.
function(bh_embed_shaders target tool folder)
  set(out "${CMAKE_CURRENT_BINARY_DIR}/shaders")
  file(GLOB sources CONFIGURE_DEPENDS "${folder}/*.glsl" "${folder}/*.vert" "${folder}/*.frag")
  add_custom_command(
    OUTPUT "${out}/embedded_shaders.cpp"
    COMMAND "${CMAKE_COMMAND}" -E rm -rf "${out}/variants"
    COMMAND "${CMAKE_COMMAND}" -E make_directory "${out}/variants"
    COMMAND ${tool} "${folder}" "${out}/variants" "${out}/embedded_shaders.cpp.new"
    COMMAND "${CMAKE_COMMAND}" -DFOLDER=${out}/variants -DVALIDATOR=${GLSLANG_VALIDATOR} -P "${BURRHOLE_SHADERS_SCRIPT}"
    COMMAND "${CMAKE_COMMAND}" -E rename "${out}/embedded_shaders.cpp.new" "${out}/embedded_shaders.cpp"
    DEPENDS ${tool} ${sources} "${BURRHOLE_SHADERS_SCRIPT}"
    COMMENT "Validating and embedding the shaders"
    VERBATIM)
  target_sources(${target} PRIVATE "${out}/embedded_shaders.cpp")
endfunction()
