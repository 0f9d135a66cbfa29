# The floor table: a module depends only on modules of strictly lower floors (ARCHITECTURE.md). A wrong DEPENDS is
# refused here, at configure time; tests/layering checks the #include lines, which CMake cannot see.
set(SILPOSE_FLOORS
  base=0
  geometry=1 image=1 filter=1 files=1
  video=2 body=2 shape=2 calibrate=2 board=2
  segment=3 render=3 motion=3 exchange=3 store=3
  likelihood=4 synth=4
  track=5 evaluate=5
  recording=6
  session=7 experiment=7 report=7)

function(silpose_floor_of NAME OUT)
  foreach(entry IN LISTS SILPOSE_FLOORS)
    if(entry MATCHES "^${NAME}=([0-9]+)$")
      set(${OUT} ${CMAKE_MATCH_1} PARENT_SCOPE)
      return()
    endif()
  endforeach()
  message(FATAL_ERROR "module '${NAME}' is not in the floor table of cmake/modules.cmake")
endfunction()

# What every target of ours is compiled with; an interface target, so that nothing leaks into consumers.
add_library(silpose_build_options INTERFACE)
target_compile_features(silpose_build_options INTERFACE cxx_std_20)
target_compile_options(silpose_build_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                       -Wno-missing-field-initializers -Werror)
if(SILPOSE_SANITIZE)
  target_compile_options(silpose_build_options INTERFACE -fsanitize=${SILPOSE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  # What the sanitizers add to the code makes GCC see uninitialized members in std::optional and std::regex.
  target_compile_options(silpose_build_options INTERFACE -Wno-maybe-uninitialized)
  target_link_options(silpose_build_options INTERFACE -fsanitize=${SILPOSE_SANITIZE})
endif()

# silpose_module(NAME [DEPENDS module...] [LINK library...] [LINK_PRIVATE library...] [TEST_DEPENDS module...])
# makes, of the folder it is called in, the library silpose::NAME from every x.cc, and the test NAME from every x_test.cc.
# LINK is for libraries seen in the module's headers. TEST_DEPENDS may name `synth` from any floor, or lower modules.
function(silpose_module NAME)
  cmake_parse_arguments(arg "" "" "DEPENDS;LINK;LINK_PRIVATE;TEST_DEPENDS" ${ARGN})
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "module '${NAME}': unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  silpose_floor_of(${NAME} own_floor)
  foreach(dependency IN LISTS arg_DEPENDS)
    silpose_floor_of(${dependency} floor)
    if(NOT floor LESS own_floor)
      message(FATAL_ERROR "module '${NAME}' (floor ${own_floor}) may not depend on '${dependency}' (floor ${floor})")
    endif()
  endforeach()
  foreach(dependency IN LISTS arg_TEST_DEPENDS)
    silpose_floor_of(${dependency} floor)
    if(NOT floor LESS own_floor AND NOT dependency STREQUAL "synth")
      message(FATAL_ERROR "tests of '${NAME}' (floor ${own_floor}) may not use '${dependency}' (floor ${floor})")
    endif()
  endforeach()

  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_test\\.cc$")
  list(FILTER tests INCLUDE REGEX "_test\\.cc$")

  list(TRANSFORM arg_DEPENDS PREPEND silpose_ OUTPUT_VARIABLE dependencies)
  add_library(silpose_${NAME} STATIC ${sources})
  add_library(silpose::${NAME} ALIAS silpose_${NAME})
  target_include_directories(silpose_${NAME} PUBLIC $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/src>)
  target_link_libraries(silpose_${NAME} PUBLIC ${dependencies} ${arg_LINK}
                        PRIVATE ${arg_LINK_PRIVATE} $<BUILD_INTERFACE:silpose_build_options>)
  set_target_properties(silpose_${NAME} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_features(silpose_${NAME} PUBLIC cxx_std_20)

  if(tests)
    list(TRANSFORM arg_TEST_DEPENDS PREPEND silpose_)
    add_executable(${NAME}_test ${tests})
    target_link_libraries(${NAME}_test PRIVATE silpose_${NAME} ${arg_TEST_DEPENDS} silpose_build_options GTest::gmock GTest::gtest GTest::gtest_main)
    target_compile_definitions(${NAME}_test PRIVATE SILPOSE_DATA_DIR="${SILPOSE_DATA_DIR}")
    set_target_properties(${NAME}_test PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
    add_test(NAME ${NAME} COMMAND ${NAME}_test WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
    set_tests_properties(${NAME} PROPERTIES LABELS unit TIMEOUT 300)
  endif()
endfunction()
