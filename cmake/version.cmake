# Included, it makes the library fathom_version; as a script (-P), it asks git and writes version.cpp and version.txt where
# they differ. One small library holds the number: a new commit compiles one file and links the programs again, no more.
#
# A tag vX.Y.Z is the version X.Y.Z. A later commit is X.Y.Z+gitTIME.COMMIT, one before the first tag is
# PROJECT_VERSION~gitTIME.COMMIT; Debian sorts these between the tags. Without git (an unpacked archive) it is
# PROJECT_VERSION; where git is there and does not answer, PROJECT_VERSION~unknown, lest a build pass for a release.

function(fathom_version_of_tree source project_version result)
  if(NOT EXISTS ${source}/.git)
    set(${result} ${project_version} PARENT_SCOPE)
    return()
  endif()
  find_program(GIT git)
  set(git ${GIT} -c safe.directory=${source} -C ${source})
  set(ENV{TZ} UTC0)
  execute_process(COMMAND ${git} log -1 --abbrev=7 --date=format-local:%Y%m%d%H%M --format=git%cd.%h
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    set(${result} ${project_version}~unknown PARENT_SCOPE)
    return()
  endif()
  execute_process(COMMAND ${git} describe --tags --abbrev=0 --match "v[0-9]*"
                  OUTPUT_VARIABLE tag OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE no_tag)
  execute_process(COMMAND ${git} describe --tags --exact-match --match "v[0-9]*"
                  OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE not_at_tag)
  string(REGEX REPLACE "^v" "" number "${tag}")
  if(no_tag)
    set(version ${project_version}~${commit})
  elseif(not_at_tag)
    set(version ${number}+${commit})
  else()
    set(version ${number})
  endif()
  execute_process(COMMAND ${git} diff --quiet HEAD ERROR_QUIET RESULT_VARIABLE modified)
  if(modified AND (no_tag OR not_at_tag))
    string(APPEND version .modified)
  elseif(modified)
    string(APPEND version +modified)
  endif()
  set(${result} ${version} PARENT_SCOPE)
endfunction()

if(CMAKE_SCRIPT_MODE_FILE)
  set(version "${STATED}")
  if(NOT version)
    fathom_version_of_tree(${SOURCE} ${PROJECT} version)
  endif()
  configure_file(${SOURCE}/cmake/version.cpp.in ${FOLDER}/version.cpp @ONLY)  # leaves a file alone that would not change
  file(CONFIGURE OUTPUT ${FOLDER}/version.txt CONTENT "${version}\n")
  return()
endif()

set(FATHOM_VERSION "" CACHE STRING "Version to state in place of what git says")
set(version_folder ${PROJECT_BINARY_DIR}/version)
add_custom_target(fathom_version_number
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DPROJECT=${PROJECT_VERSION} -DSTATED=${FATHOM_VERSION}
          -DFOLDER=${version_folder} -P ${CMAKE_CURRENT_LIST_FILE}
  BYPRODUCTS ${version_folder}/version.cpp ${version_folder}/version.txt
  COMMENT "" VERBATIM)
add_library(fathom_version STATIC ${version_folder}/version.cpp)
add_dependencies(fathom_version fathom_version_number)
target_include_directories(fathom_version PUBLIC ${PROJECT_SOURCE_DIR})
