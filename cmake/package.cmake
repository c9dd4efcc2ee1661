# cpack makes fathom_VERSION_ARCHITECTURE.deb of what `cmake --install` installs, after `cmake --build ... --target programs
# manual`. `./check --package` does all of that and tries the package.
include(GNUInstallDirs)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN decisions EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME fathom)
set(CPACK_PACKAGE_CONTACT "The Fathom developers <maintainers@fathom.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
    WORLD_EXECUTE)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "explains why an underwater vehicle moves as it does")
set(CPACK_PACKAGE_DESCRIPTION
    "Identifies the hydrodynamic model of an underwater vehicle from recordings or
on line, looks at what the model leaves unexplained, and traces that to
physical effects which the model lacks: with intervals, with what cannot be
distinguished, and with the manoeuvre that would distinguish it.

Contains the offline tool fathom, the processes of a live trial (drivers of
instruments and thrusters, vision, estimator, identifier, diagnoser,
supervisor, recorder, simulator), and the deputy that runs them on a vehicle.
They talk over LCM.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(CMAKE_CROSSCOMPILING)  # cpack would ask dpkg, which answers for the machine that builds
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()
# What is run, not linked: docs/dependencies.md.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "adduser, gnuplot-nox | gnuplot, iproute2, liblcm-bin")
get_property(python GLOBAL PROPERTY FATHOM_PYTHON_DEPENDS)  # of the module, where it is built
if(python)
  string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS ", ${python}")
endif()
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "bash-completion, chrony | time-daemon")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "default-jre, liblcm-java, libjchart2d-java, python3-numpy, python3-matplotlib")
set(debian ${CMAKE_CURRENT_LIST_DIR}/debian)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${debian}/postinst ${debian}/prerm ${debian}/postrm ${debian}/conffiles)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# When cpack runs: the version of the build, and the files that only a package has.
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_LIST_DIR}/package_version.cmake)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/package_files.cmake)
set(CPACK_FATHOM_STRIP ${CMAKE_STRIP})
set(CPACK_FATHOM_SOURCE ${PROJECT_SOURCE_DIR})
set(CPACK_FATHOM_VERSION_FILE ${PROJECT_BINARY_DIR}/version/version.txt)
set(CPACK_FATHOM_PROJECT_VERSION ${PROJECT_VERSION})
include(CPack)
