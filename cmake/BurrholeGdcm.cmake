# burrhole_gdcm: GDCM by its libraries. Debian's GDCMTargets.cmake names programs of packages that need not be there, so it cannot be used.
find_path(GDCM_INCLUDE_DIR gdcmReader.h PATH_SUFFIXES gdcm-3.0 gdcm-3 REQUIRED)
add_library(burrhole_gdcm INTERFACE IMPORTED GLOBAL)
target_include_directories(burrhole_gdcm INTERFACE "${GDCM_INCLUDE_DIR}")
foreach(name gdcmMSFF gdcmDICT gdcmIOD gdcmDSED gdcmCommon)
  find_library(${name}_LIBRARY ${name} REQUIRED)
  target_link_libraries(burrhole_gdcm INTERFACE "${${name}_LIBRARY}")
endforeach()
