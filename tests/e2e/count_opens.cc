// To be preloaded: writes a line to the file $COUNT_OPENS_LOG for every time that the program opens the file
// $COUNT_OPENS_OF for reading.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <dlfcn.h>
#include <fcntl.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

using Open = int (*)(const char*, int, ...);

void count(const char* path, int flags) {
  const char *counted = std::getenv("COUNT_OPENS_OF"), *log = std::getenv("COUNT_OPENS_LOG");
  if (counted == nullptr || log == nullptr || (flags & O_ACCMODE) != O_RDONLY || std::strcmp(path, counted) != 0)
    return;
  if (std::FILE* file = std::fopen(log, "a")) {
    std::fputs("opened\n", file);
    std::fclose(file);
  }
}

int open_next(const char* name, const char* path, int flags, mode_t mode) {
  count(path, flags);
  return reinterpret_cast<Open>(dlsym(RTLD_NEXT, name))(path, flags, mode);
}

}  // namespace

#define INTERPOSE(name)                                            \
  extern "C" int name(const char* path, int flags, ...) {          \
    va_list arguments;                                             \
    va_start(arguments, flags);                                    \
    const auto mode = static_cast<mode_t>(va_arg(arguments, int)); \
    va_end(arguments);                                             \
    return open_next(#name, path, flags, mode);                    \
  }
INTERPOSE(open)
INTERPOSE(open64)
