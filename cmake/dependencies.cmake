# Every outside library, in one place. All are Debian packages (scripts/install-dependencies).
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(TBB REQUIRED)
find_package(tl-expected REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(ZLIB REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(meshoptimizer REQUIRED)
find_package(hwy REQUIRED)
find_package(CLI11 REQUIRED)
# FlatBuffers for its headers alone, which need no target: its CMake package asks for the compiler's, too.
find_path(FLATBUFFERS_INCLUDE_DIR flatbuffers/flatbuffers.h REQUIRED)

# OpenCV's own CMake package comes with Debian's libopencv-dev, which drags in 40 more packages; the modules we use have
# packages of their own, without it.
set(SILPOSE_OPENCV_MODULES core imgproc imgcodecs videoio video dnn calib3d)
find_package(OpenCV 4.5 QUIET COMPONENTS ${SILPOSE_OPENCV_MODULES})
if(NOT OpenCV_FOUND)
  find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
  foreach(module IN LISTS SILPOSE_OPENCV_MODULES)
    find_library(OPENCV_${module}_LIBRARY opencv_${module} REQUIRED)
    add_library(opencv_${module} SHARED IMPORTED)
    set_target_properties(opencv_${module} PROPERTIES IMPORTED_LOCATION ${OPENCV_${module}_LIBRARY}
                          INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
  endforeach()
endif()

find_package(GTest REQUIRED)
find_package(assimp REQUIRED)  # for tests: a reader of the glTF that is written
find_package(benchmark REQUIRED)

# Optional: pipelines that silpose_bench is compared with (scripts/install-bench-peers).
find_package(OpenGL QUIET COMPONENTS OpenGL EGL)
find_package(embree 3 QUIET)
