# fathom_cases(TARGET LABEL [SEARCH FILE...]): an entry of ctest for every doctest case of an executable. The executable
# lists its cases after it has been linked; ctest reads the list when it starts, so new cases need no new configuration.
# LABEL is that of cases in no doctest suite; those of the files after SEARCH have that one. What labels mean:
# cmake/ctest_case.cmake.
set(FATHOM_SLOWER 1)
if(FATHOM_SANITIZE)
  set(FATHOM_SLOWER 6)
elseif(CMAKE_CROSSCOMPILING)  # an emulator; what counts in floating point takes thirty times as long
  set(FATHOM_SLOWER 40)
endif()

function(fathom_cases target label)
  cmake_parse_arguments(files "" "" SEARCH ${ARGN})
  set(cases ${CMAKE_CURRENT_BINARY_DIR}/${target}_cases.cmake)
  set(entries ${CMAKE_CURRENT_BINARY_DIR}/${target}_entries.cmake)
  string(REGEX REPLACE "^test_(common_)?" "" room ${target})
  # An emulator where one is needed to run what has been compiled for another processor.
  set(run $<TARGET_PROPERTY:${target},CROSSCOMPILING_EMULATOR> $<TARGET_FILE:${target}>)
  add_custom_command(TARGET ${target} POST_BUILD BYPRODUCTS ${cases} COMMAND ${run} --list-for-ctest ${cases}
                     COMMENT "" VERBATIM COMMAND_EXPAND_LISTS)
  file(GENERATE OUTPUT ${entries} CONTENT
"set(FATHOM_ROOM [==[${room}]==])
set(FATHOM_RUN [==[${run}]==])
set(FATHOM_LABEL ${label})
set(FATHOM_SEARCH [==[${files_SEARCH}]==])
set(FATHOM_SLOWER ${FATHOM_SLOWER})
include([==[${PROJECT_SOURCE_DIR}/cmake/ctest_case.cmake]==])
if(EXISTS [==[${cases}]==])
  include([==[${cases}]==])
else()
  fathom_not_built()
endif()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${entries})
endfunction()
