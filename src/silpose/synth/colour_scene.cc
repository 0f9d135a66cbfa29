#include "silpose/synth/colour_scene.h"

#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"

namespace silpose {
namespace {

constexpr double kWallBehind = 3;  // m behind the middle of the path

// One stream per row, so that rows may be drawn by any thread.
void add_sensor_noise(ByteImage& image, double sd, uint64_t seed, uint64_t camera_idx, uint64_t frame) {
  if (sd <= 0) return;
  parallel_for(static_cast<size_t>(image.height()), 32, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      Rng rng(seed + 1 + camera_idx, frame + 1, y);
      for (uint8_t& value : image.row(static_cast<int>(y))) {
        value = static_cast<uint8_t>(std::lround(std::clamp(value + sd * rng.normal(), 0.0, 255.0)));
      }
    }
  });
}

}  // namespace

ColourScene::ColourScene(const SyntheticSequence& sequence, int camera_idx, const ColourOptions& options)
    : sequence_(&sequence), camera_idx_(camera_idx), options_(options) {
  check(camera_idx >= 0 && static_cast<size_t>(camera_idx) < sequence.cameras.size(), "ColourScene: camera {} of {}",
        camera_idx, sequence.cameras.size());
  backdrop_ = draw_backdrop(sequence.cameras[static_cast<size_t>(camera_idx)], options.backdrop,
                            sequence.distance_m + kWallBehind, options.seed);
  colours_ = clothing_colours(*sequence.body);
}

ByteImage ColourScene::draw(int frame) const {
  ByteImage image = backdrop_;
  const std::span<const double> pose = pose_of_frame(*sequence_, frame);
  if (!pose.empty()) {
    const std::vector<Eigen::Vector3f> vertices = skin_vertices(*sequence_->body, pose);
    Lighting lighting;
    lighting.shadow = options_.shadow;
    draw_shaded(sequence_->cameras[static_cast<size_t>(camera_idx_)], vertices, sequence_->body->rest.faces, colours_,
                lighting, image);
  }
  add_sensor_noise(image, options_.noise_sd, options_.seed, static_cast<uint64_t>(camera_idx_),
                   static_cast<uint64_t>(frame));
  return image;
}

}  // namespace silpose
