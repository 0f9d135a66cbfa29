// Descriptions of experiments.
#include "silpose/experiment/grid.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace silpose;
  const auto file = fuzz::file_with(fuzz::text_of(data, size));
  (void)read_grid(file, false);
  (void)read_grid(file, true);
  return 0;
}
