# cmake -DSOURCE=... -DOUT=... -P commit.cmake: writes a header with the commit this is built from. It is touched only
# when that changes.
set(commit unknown)
find_package(Git QUIET)
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} describe --always --dirty --abbrev=12
                  OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(commit ${described})
  endif()
endif()
set(text "#pragma once\n#define SILPOSE_COMMIT \"${commit}\"\n")
set(earlier "")
if(EXISTS ${OUT})
  file(READ ${OUT} earlier)
endif()
if(NOT earlier STREQUAL text)
  file(WRITE ${OUT} "${text}")
endif()
