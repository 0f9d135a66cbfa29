// Body files with a correct checksum.
#include "silpose/body/body_model.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace silpose;
  (void)load_body(fuzz::file_with(fuzz::sealed(fuzz::text_of(data, size))));
  return 0;
}
