# What the libraries link, for the build (dependencies.cmake) and for programs that use an installed silpose
# (silposeConfig.cmake), which includes this file too. Both define silpose_find(), which finds a package, and
# silpose_missing(), which is called where one is not there. All are Debian packages (scripts/install-dependencies).
silpose_find(Threads)
silpose_find(Eigen3 3.4 NO_MODULE)
silpose_find(fmt)
silpose_find(TBB)
silpose_find(tl-expected)
silpose_find(tomlplusplus)
silpose_find(nlohmann_json)
silpose_find(ZLIB)
silpose_find(OpenSSL COMPONENTS Crypto)
silpose_find(meshoptimizer)
silpose_find(hwy)

# OpenCV's own CMake package comes with Debian's libopencv-dev, which depends on 40 more packages; the modules we use have
# packages of their own, without it.
set(SILPOSE_OPENCV_MODULES core imgproc imgcodecs videoio video dnn calib3d)
find_package(OpenCV 4.5 QUIET COMPONENTS ${SILPOSE_OPENCV_MODULES})
if(NOT OpenCV_FOUND)
  find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
  if(NOT OPENCV_INCLUDE_DIR)
    silpose_missing("OpenCV's headers")
  endif()
  foreach(module IN LISTS SILPOSE_OPENCV_MODULES)
    find_library(OPENCV_${module}_LIBRARY opencv_${module})
    if(NOT OPENCV_${module}_LIBRARY)
      silpose_missing("library opencv_${module}")
    elseif(NOT TARGET opencv_${module})
      add_library(opencv_${module} SHARED IMPORTED GLOBAL)
      set_target_properties(opencv_${module} PROPERTIES IMPORTED_LOCATION ${OPENCV_${module}_LIBRARY}
                            INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
    endif()
  endforeach()
endif()
