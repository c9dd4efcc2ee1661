# Read by ctest, with FATHOM_ROOM, FATHOM_RUN, FATHOM_LABEL, FATHOM_SEARCH and FATHOM_SLOWER of one executable: its cases
# as entries.
#
# Every case has one of four labels, from its doctest suite, else from its file, else from its executable:
#   unit       at most some seconds; all of them in less than a minute on two cores (./check --quick)
#   search     whole fits, searches and simulated dives in virtual time
#   processes  runs the programs
#   survival   runs whole trials, and kills, cuts and floods what takes part
# Further words of a suite's name are further labels: `golden`, the replays whose numbers are kept in test/golden.
# The time limit is for machines that are much slower or busy with other things: what takes longer hangs. Long kinds begin
# first, so that no core waits for the last of them.
cmake_policy(VERSION 3.25)
set(FATHOM_LIMIT_unit 180)
set(FATHOM_LIMIT_search 900)
set(FATHOM_LIMIT_processes 400)
set(FATHOM_LIMIT_survival 600)
set(FATHOM_COST_unit 1)
set(FATHOM_COST_processes 10)
set(FATHOM_COST_search 100)
set(FATHOM_COST_survival 1000)

function(fathom_case name suite file)
  string(REPLACE " " ";" labels "${suite}")
  if(labels STREQUAL "")
    set(labels "${FATHOM_LABEL}")
    if(file IN_LIST FATHOM_SEARCH)
      set(labels search)
    endif()
  endif()
  list(GET labels 0 label)
  if(NOT DEFINED "FATHOM_LIMIT_${label}")
    message(FATAL_ERROR "${FATHOM_ROOM}: ${name}: suite '${label}' is no label; see ${CMAKE_CURRENT_FUNCTION_LIST_FILE}")
  endif()
  math(EXPR limit "${FATHOM_SLOWER} * ${FATHOM_LIMIT_${label}}")
  set(entry "${FATHOM_ROOM}: ${name}")
  add_test("${entry}" ${FATHOM_RUN} --exactly "${name}")
  # 77: this machine cannot run it, and nothing was asserted (test/support/main.cpp).
  set_tests_properties("${entry}" PROPERTIES LABELS "${labels}" TIMEOUT ${limit} COST ${FATHOM_COST_${label}}
                       SKIP_RETURN_CODE 77)
endfunction()

# An executable that has not been built fails as one entry.
function(fathom_not_built)
  add_test("${FATHOM_ROOM}: not built" "${FATHOM_ROOM} has not been built")
  set_tests_properties("${FATHOM_ROOM}: not built" PROPERTIES LABELS "${FATHOM_LABEL}")
endfunction()
