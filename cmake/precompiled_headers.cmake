# The outside headers that most sources include, compiled once for the libraries and once for their tests. That hides a
# missing #include, so only the release preset turns it on: the other presets find those.
set(precompiled <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory> <optional>
                <span> <string> <variant> <vector> <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <tl/expected.hpp>)

# silpose_reuse_precompiled(TARGET FROM): nothing where precompiled headers are off.
function(silpose_reuse_precompiled TARGET FROM)
  if(SILPOSE_PRECOMPILED_HEADERS)
    target_precompile_headers(${TARGET} REUSE_FROM ${FROM})
  endif()
endfunction()

function(silpose_precompile NAME)
  set(source ${PROJECT_BINARY_DIR}/precompiled.cc)
  if(NOT EXISTS ${source})
    file(WRITE ${source} "")
  endif()
  add_library(${NAME} OBJECT ${source})
  target_link_libraries(${NAME} PRIVATE silpose_build_options Eigen3::Eigen fmt::fmt tl::expected)
  target_precompile_headers(${NAME} PRIVATE ${precompiled})
endfunction()

if(SILPOSE_PRECOMPILED_HEADERS)
  silpose_precompile(silpose_precompiled)
  set_target_properties(silpose_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)
  if(SILPOSE_BUILD_TESTS)
    silpose_precompile(silpose_precompiled_tests)
    target_link_libraries(silpose_precompiled_tests PRIVATE silpose_test_options GTest::gmock GTest::gtest)
    target_precompile_headers(silpose_precompiled_tests PRIVATE <gmock/gmock.h> <gtest/gtest.h>)
  endif()
endif()
