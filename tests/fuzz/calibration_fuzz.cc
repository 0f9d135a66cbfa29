// Calibration files: cameras that are read have a rotation.
#include "silpose/geometry/calibration_file.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace silpose;
  const Result<Calibration> read = load_calibration(fuzz::file_with(fuzz::text_of(data, size)));
  if (!read) return 0;
  for (const PinholeCamera& camera : read->cameras) {
    const Eigen::Matrix3d& rotation = camera.cam_from_world.rotation;
    if (!((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-6)) std::abort();
  }
  return 0;
}
