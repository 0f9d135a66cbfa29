// CSV tables: poses and joints.
#include "silpose/body/test_body.h"
#include "silpose/exchange/tables.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace silpose;
  static const BodyModel body = make_test_body();
  const auto file = fuzz::file_with(fuzz::text_of(data, size));
  (void)read_poses(file, body.skeleton);
  (void)read_joints(file);
  return 0;
}
