# The floor table: a module depends only on modules of strictly lower floors (ARCHITECTURE.md). A wrong DEPENDS is
# refused here, at configure time; tests/layering checks the #include lines, which CMake cannot see.
set(SILPOSE_FLOORS
  base=0
  geometry=1 image=1 filter=1 files=1
  video=2 body=2 shape=2 calibrate=2 board=2
  segment=3 render=3 motion=3 human=3 mocap=3 store=3
  likelihood=4 exchange=4
  synth=5 fit=5 evaluate=5
  track=6
  offline=7 recording=7
  report=8
  session=9 experiment=9)

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
                       -Wno-missing-field-initializers)
if(SILPOSE_WARNINGS_AS_ERRORS)
  target_compile_options(silpose_build_options INTERFACE -Werror)
endif()
if(SILPOSE_SANITIZE)
  target_compile_options(silpose_build_options INTERFACE -fsanitize=${SILPOSE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  # What the sanitizers add to the code makes GCC see uninitialized members in std::optional and std::regex.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(silpose_build_options INTERFACE -Wno-maybe-uninitialized)
  endif()
  target_link_options(silpose_build_options INTERFACE -fsanitize=${SILPOSE_SANITIZE})
endif()
if(SILPOSE_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "SILPOSE_FUZZ needs clang: cmake --preset fuzz")
  endif()
  target_compile_options(silpose_build_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

# What unit tests are compiled with: optimised less, because they are most of the compiler's work and little of the time
# that the tests take.
add_library(silpose_test_options INTERFACE)
target_compile_options(silpose_test_options INTERFACE $<$<CONFIG:Release>:-O1>)

include(${CMAKE_CURRENT_LIST_DIR}/precompiled_headers.cmake)

# silpose_timeout(SECONDS OUT): a test's time limit. Sanitizers slow programs down by 2 to 15 times (their manuals).
function(silpose_timeout SECONDS OUT)
  if(SILPOSE_SANITIZE)
    math(EXPR SECONDS "${SECONDS} * 10")
  endif()
  set(${OUT} ${SECONDS} PARENT_SCOPE)
endfunction()

# silpose_module(NAME [DEPENDS module...] [LINK library...] [LINK_PRIVATE library...] [TEST_DEPENDS module...])
# makes, of the folder it is called in, the library silpose::NAME from every x.cc, and the test NAME from every x_test.cc.
# The library and its headers are installed and exported, but those for tests (x_for_test.h) and x-inl.h.
# LINK is for libraries seen in the module's headers. TEST_DEPENDS may name lower
# modules, and `synth` and `human` from any floor.
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
    if(NOT floor LESS own_floor AND NOT dependency MATCHES "^(synth|human)$")
      message(FATAL_ERROR "tests of '${NAME}' (floor ${own_floor}) may not use '${dependency}' (floor ${floor})")
    endif()
  endforeach()

  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_test\\.cc$")
  list(FILTER tests INCLUDE REGEX "_test\\.cc$")

  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
  list(FILTER headers EXCLUDE REGEX "(_for_test|-inl)\\.h$")

  list(TRANSFORM arg_DEPENDS PREPEND silpose_ OUTPUT_VARIABLE dependencies)
  add_library(silpose_${NAME} STATIC ${sources})
  add_library(silpose::${NAME} ALIAS silpose_${NAME})
  target_sources(silpose_${NAME} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${headers})
  target_link_libraries(silpose_${NAME} PUBLIC ${dependencies} ${arg_LINK}
                        PRIVATE ${arg_LINK_PRIVATE} $<BUILD_INTERFACE:silpose_build_options>)
  set_target_properties(silpose_${NAME} PROPERTIES POSITION_INDEPENDENT_CODE ON EXPORT_NAME ${NAME})
  target_compile_features(silpose_${NAME} PUBLIC cxx_std_20)
  silpose_reuse_precompiled(silpose_${NAME} silpose_precompiled)
  if(SILPOSE_INSTALL)
    install(TARGETS silpose_${NAME} EXPORT silposeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
            FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  endif()

  if(tests AND SILPOSE_BUILD_TESTS)
    list(TRANSFORM arg_TEST_DEPENDS PREPEND silpose_)
    add_executable(${NAME}_test ${tests})
    target_link_libraries(${NAME}_test PRIVATE silpose_${NAME} ${arg_TEST_DEPENDS} silpose_build_options silpose_test_options GTest::gmock GTest::gtest GTest::gtest_main)
    target_compile_definitions(${NAME}_test PRIVATE SILPOSE_DATA_DIR="${SILPOSE_DATA_DIR}")
    silpose_reuse_precompiled(${NAME}_test silpose_precompiled_tests)
    set_target_properties(${NAME}_test PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
    silpose_timeout(300 timeout)
    add_test(NAME ${NAME} COMMAND ${NAME}_test WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
    set_tests_properties(${NAME} PROPERTIES LABELS unit TIMEOUT ${timeout})
  endif()
endfunction()
