# Read by cpack: the package has the version that its programs were built with.
if(NOT EXISTS ${CPACK_FATHOM_VERSION_FILE})
  message(FATAL_ERROR "Build before packing: cmake --build --preset release --target programs manual")
endif()
file(STRINGS ${CPACK_FATHOM_VERSION_FILE} CPACK_PACKAGE_VERSION LIMIT_COUNT 1)
if(CPACK_PACKAGE_VERSION MATCHES "^[0-9.]+$" AND NOT CPACK_PACKAGE_VERSION STREQUAL CPACK_FATHOM_PROJECT_VERSION)
  message(FATAL_ERROR "The tag says ${CPACK_PACKAGE_VERSION}, project() in CMakeLists.txt ${CPACK_FATHOM_PROJECT_VERSION}, "
          "which an archive without git would say; make them agree")
endif()
