# Every package is Debian 12's own; docs/dependencies.md says what each is for.
find_package(PkgConfig REQUIRED)
pkg_check_modules(LCM REQUIRED IMPORTED_TARGET lcm)
pkg_check_modules(SODIUM REQUIRED IMPORTED_TARGET libsodium)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(spdlog REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Ceres REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(Threads REQUIRED)

# What recordings of others are packed with.
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(SQLITE REQUIRED IMPORTED_TARGET sqlite3)
pkg_check_modules(MATIO REQUIRED IMPORTED_TARGET matio)
pkg_check_modules(LIBZIP REQUIRED IMPORTED_TARGET libzip)
find_package(BZip2 REQUIRED)
pkg_check_modules(TINYXML2 REQUIRED IMPORTED_TARGET tinyxml2)

# OpenCV by its parts: Debian's configuration file comes with the whole, some hundred packages more. `codecs` reads and
# writes pictures and videos and loads 200 libraries at every start; programs that need none of that do without.
find_path(OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
function(fathom_opencv name)
  add_library(opencv_${name} INTERFACE)
  target_include_directories(opencv_${name} SYSTEM INTERFACE ${OPENCV_INCLUDE})
  foreach(part ${ARGN})
    find_library(OPENCV_${part} opencv_${part} REQUIRED)
    target_link_libraries(opencv_${name} INTERFACE ${OPENCV_${part}})
  endforeach()
endfunction()
fathom_opencv(plain core imgproc features2d calib3d video)
fathom_opencv(codecs core imgproc imgcodecs videoio)
find_package(JPEG REQUIRED)
pkg_check_modules(APRILTAG REQUIRED IMPORTED_TARGET apriltag)

# Asio without Boost: headers alone.
find_path(ASIO_INCLUDE asio.hpp REQUIRED)
add_library(asio INTERFACE)
target_include_directories(asio SYSTEM INTERFACE ${ASIO_INCLUDE})
target_compile_definitions(asio INTERFACE ASIO_STANDALONE ASIO_NO_DEPRECATED)

pkg_check_modules(HTTPLIB REQUIRED IMPORTED_TARGET cpp-httplib)
