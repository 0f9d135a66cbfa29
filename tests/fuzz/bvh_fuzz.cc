// BVH files: what is read can be played.
#include "silpose/exchange/bvh.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace silpose;
  const Result<Clip> clip = read_bvh(fuzz::file_with(fuzz::text_of(data, size)));
  if (clip && clip->num_frames() > 0) (void)clip->forward_kinematics(clip->num_frames() - 1);
  return 0;
}
