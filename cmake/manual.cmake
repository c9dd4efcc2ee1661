# Target `manual`: man pages and shell completion, written by the programs themselves. Not part of `all`: who builds to
# try something has --help.
include(GNUInstallDirs)
get_property(programs GLOBAL PROPERTY FATHOM_PROGRAMS)
set(manual ${PROJECT_BINARY_DIR}/manual)
set(pairs)
foreach(name ${programs})
  set(installed fathom-${name})
  if(name STREQUAL "fathom")
    set(installed fathom)
  endif()
  list(APPEND pairs ${installed}=$<TARGET_FILE:${name}>)
endforeach()
add_custom_command(
  OUTPUT ${manual}/completions/fathom
  COMMAND sh ${CMAKE_CURRENT_LIST_DIR}/manual.sh ${manual} ${CMAKE_CURRENT_LIST_DIR}/completion.bash
          ${CMAKE_CROSSCOMPILING_EMULATOR} -- ${pairs}
  DEPENDS ${programs} ${CMAKE_CURRENT_LIST_DIR}/manual.sh ${CMAKE_CURRENT_LIST_DIR}/completion.bash
  COMMENT "Man pages and completion"
  VERBATIM)
add_custom_target(programs DEPENDS ${programs})  # what is installed
foreach(extra fathom_types_jar fathom_python)
  if(TARGET ${extra})
    add_dependencies(programs ${extra})
  endif()
endforeach()
add_custom_target(manual DEPENDS ${manual}/completions/fathom)
install(DIRECTORY ${manual}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} OPTIONAL)
install(DIRECTORY ${manual}/completions DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion OPTIONAL)
