// Option files of --config.
#include "silpose/base/option_file.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace silpose;
  const auto options = read_option_file(fuzz::file_with(fuzz::text_of(data, size)));
  if (!options) return 0;
  for (const FileOption& option : *options) (void)toml_list(option.values);
  return 0;
}
