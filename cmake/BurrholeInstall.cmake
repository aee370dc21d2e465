# Install and export: libraries, headers, the program, scenes and tools, and a package that `find_package(burrhole)` reads.
include(CMakePackageConfigHelpers)

set(BURRHOLE_PACKAGE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/burrhole")

# Options may leave a folder out, so whatever libraries exist are installed.
set(burrhole_installed "")
foreach(name core haptics volumes view session stage effect scene run report job render lab_oracle lab)
  if(TARGET burrhole_${name})
    list(APPEND burrhole_installed burrhole_${name})
  endif()
endforeach()
install(TARGETS ${burrhole_installed} EXPORT burrholeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET burrhole)
  install(TARGETS burrhole RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

# Headers keep their folders: #include "core/base/geometry.h" reads the same in the tree and in a client. The wrapper round toml++
# stays home.
foreach(folder core haptics volumes app/view app/session app/stage app/effect app/scene app/run app/report app/job app/render)
  if(EXISTS "${PROJECT_SOURCE_DIR}/${folder}")
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/burrhole/${folder}"
      FILES_MATCHING PATTERN "*.h" PATTERN "registry.inc" PATTERN "*-inl.h" EXCLUDE PATTERN "toml_parsed.h" EXCLUDE PATTERN "sqlite_file.h" EXCLUDE
        REGEX "render/(added_mesh_buffer|bone_buffer|bone_paint|gl_object|gl_target|read_buffer|shader_program|tool_depth|tool_mesh|transfer_texture|triangle_chunks|upload_ring|volume_texture|renderer_impl|skin_mesh)[.]h$" EXCLUDE
        PATTERN "oracle" EXCLUDE)
  endif()
endforeach()
foreach(folder scenes tools)
  if(EXISTS "${PROJECT_SOURCE_DIR}/app/${folder}")
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/app/${folder}" DESTINATION "${CMAKE_INSTALL_DATADIR}/burrhole"
      FILES_MATCHING PATTERN "*.toml")
  endif()
endforeach()
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")

install(EXPORT burrholeTargets NAMESPACE burrhole:: DESTINATION ${BURRHOLE_PACKAGE_DIR})
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/burrholeConfig.cmake.in" "${PROJECT_BINARY_DIR}/burrholeConfig.cmake"
  INSTALL_DESTINATION ${BURRHOLE_PACKAGE_DIR})
write_basic_package_version_file("${PROJECT_BINARY_DIR}/burrholeConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/burrholeConfig.cmake" "${PROJECT_BINARY_DIR}/burrholeConfigVersion.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/BurrholeGdcm.cmake" DESTINATION ${BURRHOLE_PACKAGE_DIR})
