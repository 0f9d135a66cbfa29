# Every outside library. What is found is seen by a project that this one is a part of, too: it links the same targets.
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)
macro(silpose_find)
  find_package(${ARGN} REQUIRED)
endmacro()
macro(silpose_missing WHAT)
  message(FATAL_ERROR "${WHAT} not found (scripts/install-dependencies)")
endmacro()
include(${CMAKE_CURRENT_LIST_DIR}/libraries.cmake)

# Headers alone, which need no target. FlatBuffers' own CMake package asks for its compiler, too.
find_path(FLATBUFFERS_INCLUDE_DIR flatbuffers/flatbuffers.h REQUIRED)

if(SILPOSE_BUILD_APPS OR SILPOSE_BUILD_TESTS OR SILPOSE_FUZZ)
  find_package(CLI11 REQUIRED)
endif()
if(SILPOSE_BUILD_TESTS)
  find_package(GTest REQUIRED)
  find_package(assimp REQUIRED)  # a reader of the glTF that is written
  # Optional: pipelines that silpose_bench is compared with (scripts/install-bench-peers).
  find_package(OpenGL QUIET COMPONENTS OpenGL EGL)
  find_package(embree 3 QUIET)
endif()
