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
# One code for programs and for Python's module, which must be position-independent; calls within a program are as direct
# as without, since nothing may put itself in a symbol's place.
add_compile_options(-fPIC -fno-semantic-interposition)
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
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")  # guesses wrongly of std::regex and others that are instrumented
    target_compile_options(fathom_warnings INTERFACE -Wno-maybe-uninitialized)
  endif()
  # Ceres, which is not instrumented, frees what Eigen has allocated here: both must take it from malloc as it is. The
  # sanitizer's is aligned as the C library's is, but Eigen does not trust it.
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
  add_link_options(-fsanitize=address,undefined)
endif()

# A precompiled header is no system header to what GCC guesses after inlining; builds without one keep these warnings.
if(FATHOM_PCH AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(fathom_warnings INTERFACE -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread)
endif()
if(FATHOM_UNITY)  # a local name may be that of another source's constant; builds without unity files keep this warning
  target_compile_options(fathom_warnings INTERFACE -Wno-shadow $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
# What nearly every source reads, read once: a precompiled header per layer and per set of compiler options, made by an
# empty library that lends it to all others. FATHOM_PCH=OFF builds without, as FATHOM_UNITY=OFF does without unity files:
# `./check --includes` does, so that every source names what it uses.
if(FATHOM_PCH)
  add_compile_options(-pthread)  # one of LCM's; the same everywhere, since a precompiled header insists on the same macros
endif()
function(fathom_precompile layer)
  cmake_parse_arguments(arg "" "" "HEADERS;LINK;OPTIONS" ${ARGN})
  set(empty ${CMAKE_CURRENT_BINARY_DIR}/pch_${layer}.cpp)
  file(GENERATE OUTPUT ${empty} CONTENT "// Holds nothing: its library lends its precompiled header.\n")
  add_library(fathom_pch_${layer} OBJECT EXCLUDE_FROM_ALL ${empty})
  target_link_libraries(fathom_pch_${layer} PRIVATE fathom_warnings ${arg_LINK})
  target_compile_options(fathom_pch_${layer} PRIVATE ${arg_OPTIONS})
  target_precompile_headers(fathom_pch_${layer} PRIVATE ${arg_HEADERS})
endfunction()
# fathom_lean(TARGET LAYER): compiled with the layer's precompiled header.
function(fathom_lean target layer)
  if(FATHOM_PCH)
    target_precompile_headers(${target} REUSE_FROM fathom_pch_${layer})
  endif()
endfunction()
include(unity)
set(FATHOM_FAST_ROOMS model identification joint)  # nearly all of a diagnosis is spent in the steps of their rollouts
set(FATHOM_FILTER_ROOMS likelihood inference)  # at -O3 fixed-size products take minutes to compile and run no faster
set(FATHOM_FAST_OPTIONS)
set(FATHOM_FILTER_OPTIONS)
if(FATHOM_SANITIZE)  # at the -O1 of the rest whole diagnoses would take the suite many hours
  set(FATHOM_FAST_OPTIONS -O2)
  set(FATHOM_FILTER_OPTIONS -O2)
endif()
if(NOT FATHOM_SANITIZE AND NOT FATHOM_FUZZ)
  set(FATHOM_FILTER_OPTIONS -fno-math-errno -fno-trapping-math)
  set(FATHOM_FAST_OPTIONS $<$<NOT:$<CONFIG:Debug>>:-O3> -fno-math-errno -fno-trapping-math
      $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-free-nonheap-object;-Wno-restrict;-Wno-stringop-overflow>)
endif()
if(FATHOM_PCH)
  set(plain <algorithm> <array> <charconv> <chrono> <cmath> <cstdint> <cstdio> <deque> <filesystem> <fstream> <functional>
      <iterator> <limits> <map> <memory> <numbers> <numeric> <optional> <random> <set> <span> <sstream> <stdexcept> <string>
      <string_view> <tuple> <utility> <variant> <vector> <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry> <Eigen/LU> <Eigen/QR>)
  fathom_precompile(core HEADERS ${plain} LINK Eigen3::Eigen)
  fathom_precompile(fast HEADERS ${plain} LINK Eigen3::Eigen OPTIONS ${FATHOM_FAST_OPTIONS})
  fathom_precompile(filter HEADERS ${plain} LINK Eigen3::Eigen OPTIONS ${FATHOM_FILTER_OPTIONS})
  if(FATHOM_TESTS)
    find_package(doctest REQUIRED)
    fathom_precompile(test HEADERS ${plain} <doctest/doctest.h> LINK Eigen3::Eigen doctest::doctest)
  endif()
endif()

function(fathom_room name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  if(sources)
    fathom_unite(united ${name} ${sources})
    add_library(fathom_${name} STATIC ${united})
    set(scope PUBLIC)
    target_link_libraries(fathom_${name} PRIVATE fathom_warnings)
    if(name IN_LIST FATHOM_FAST_ROOMS)
      target_compile_options(fathom_${name} PRIVATE ${FATHOM_FAST_OPTIONS})
      fathom_lean(fathom_${name} fast)
    elseif(name IN_LIST FATHOM_FILTER_ROOMS)
      target_compile_options(fathom_${name} PRIVATE ${FATHOM_FILTER_OPTIONS})
      fathom_lean(fathom_${name} filter)
    else()
      fathom_lean(fathom_${name} core)
    endif()
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
  fathom_unite(sources process_${name} ${sources})
  add_executable(${name} ${sources})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE fathom_warnings)
  fathom_lean(${name} core)
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
