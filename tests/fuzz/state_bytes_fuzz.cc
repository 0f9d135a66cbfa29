// Saved state, what checkpoints consist of: what can be read is written as the same bytes.
#include "tests/fuzz/checkpoint_state.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace silpose;
  fuzz::State state;
  const std::string_view bytes = fuzz::text_of(data, size);
  if (from_bytes(bytes, state) && to_bytes(state) != bytes) std::abort();
  return 0;
}
