// Network files.
#include "silpose/segment/tflite_file.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace silpose;
  (void)read_tflite(fuzz::file_with(fuzz::text_of(data, size)));
  return 0;
}
