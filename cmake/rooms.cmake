# fathom_room(NAME lower rooms and packages...): one library per folder of common/, its sources found by name.
# fathom_process(NAME rooms...): one executable per folder of processes/, installed as fathom-NAME.

add_library(fathom_warnings INTERFACE)
target_compile_options(fathom_warnings INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
                       -Wno-missing-field-initializers)  # designated initializers leave the rest at its default on purpose
# What GCC guesses about code that it inlines at -O3 is wrong about Eigen and std::string; the presets build at -O2.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_BUILD_TYPE STREQUAL "Release" AND CMAKE_CXX_FLAGS_RELEASE MATCHES "-O3")
  target_compile_options(fathom_warnings INTERFACE -Wno-error=array-bounds -Wno-error=free-nonheap-object
                         -Wno-error=restrict -Wno-error=stringop-overflow -Wno-error=stringop-overread)
endif()
# The compiler may fuse a product and a sum into one operation where the processor has it (arm64), which rounds once
# instead of twice. Without that a log gives nearly the same numbers on the vehicle and on the shore
# (docs/decisions/116-*).
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-ffp-contract=off)
endif()
if(FATHOM_FUZZ)  # every room is instrumented; clang's own further warnings are no errors here
  target_compile_options(fathom_warnings INTERFACE -Wno-error)
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
                      -DFUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION)
  add_link_options(-fsanitize=address,undefined)
endif()
if(FATHOM_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()

function(fathom_room name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  if(sources)
    add_library(fathom_${name} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(fathom_${name} PRIVATE fathom_warnings)
  else()
    add_library(fathom_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_include_directories(fathom_${name} ${scope} ${PROJECT_SOURCE_DIR})
  foreach(need ${ARGN})
    if(TARGET fathom_${need})
      target_link_libraries(fathom_${name} ${scope} fathom_${need})
    else()
      target_link_libraries(fathom_${name} ${scope} ${need})
    endif()
  endforeach()
endfunction()

function(fathom_process name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  add_executable(${name} ${sources})
  target_link_libraries(${name} PRIVATE fathom_warnings)
  foreach(need ${ARGN})
    target_link_libraries(${name} PRIVATE fathom_${need})
  endforeach()
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  set_property(GLOBAL APPEND PROPERTY FATHOM_PROGRAMS ${name})
  include(GNUInstallDirs)
  if(name STREQUAL "fathom")
    install(TARGETS fathom)
    return()
  endif()
  # Names like "estimator" are too plain for a system's bin folder. Configurations of procman use the installed name.
  install(PROGRAMS $<TARGET_FILE:${name}> DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME fathom-${name})
  add_custom_command(TARGET ${name} POST_BUILD COMMAND ${CMAKE_COMMAND} -E create_symlink ${name} fathom-${name}
                     WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/bin VERBATIM)
endfunction()
