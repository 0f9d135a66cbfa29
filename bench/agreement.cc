#include "agreement.h"

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/body/random_pose.h"
#include "silpose/geometry/rigid3.h"
#include "silpose/render/silhouette.h"

namespace silpose::bench {
namespace {

constexpr int kSize = 128, kCameras = 4;

struct Views {
  std::vector<PinholeCamera> cameras;
  Window window{
      .x0 = 140, .y0 = 60, .scale_x = kSize / 360.0, .scale_y = kSize / 360.0, .width = kSize, .height = kSize};
  Views() {
    for (int c = 0; c < kCameras; ++c) {
      const double angle = 0.3 + 2 * kPi * c / kCameras;
      cameras.push_back(
          look_at_camera(640, 480, 700, {4 * std::sin(angle), 0.6 + 0.5 * c, 4 * std::cos(angle)}, {0, 0.9, 0}));
    }
  }
};

// Random poses and how the plain renderer draws them for each camera.
class Trial {
 public:
  Trial(const std::shared_ptr<const BodyModel>& body, size_t num_poses)
      : body_(body), topology_(body->rest.faces), references_(num_poses * kCameras), differing_(references_.size()) {
    const std::vector<double> standing = standing_pose(*body);
    for (size_t n = 0; n < num_poses; ++n) {
      Rng rng(3, n);
      poses_.push_back(random_pose(body->skeleton, standing, rng));
    }
    for_all([&](OutlineRenderer&, const auto& pixels, size_t i) {
      draw_silhouette_reference(pixels, body_->rest.faces, views_.window, references_[i]);
    });
  }

  [[nodiscard]] long long num_pixels() const {
    long long sum = 0;
    for (const Mask& reference : references_) sum += reference.count();
    return sum;
  }

  // Pixels that differ when drawn from the same projected vertices by the instruction set in use.
  long long differing_from_pixels() {
    for_all([&](OutlineRenderer& renderer, const auto& pixels, size_t i) {
      Mask mask;
      renderer.draw(pixels, views_.window, mask);
      differing_[i] = xor_count(mask, references_[i]);
    });
    return sum_of_differing();
  }

  // Pixels that differ when drawn from the same poses.
  long long differing_from_poses() {
    for (size_t c = 0; c < kCameras; ++c) {
      const BatchRenderer renderer(body_, views_.cameras[c]);
      for (size_t n = 0; n < poses_.size(); ++n) {
        const Mask& reference = references_[n * kCameras + c];
        const std::vector<double>& pose = poses_[n];
        OutlineRenderer::Counts counts;
        renderer.counts({pose.data(), 1, pose.size(), pose.size()}, views_.window, reference, {&counts, 1});
        differing_[n * kCameras + c] = counts.model + reference.count() - 2 * counts.both;
      }
    }
    return sum_of_differing();
  }

 private:
  // draw(renderer, pixels, index) for every pose and camera.
  template <class Draw>
  void for_all(const Draw& draw) const {
    parallel_for(poses_.size(), 4, [&](size_t begin, size_t end) {
      OutlineRenderer renderer(topology_);
      std::vector<Eigen::Vector2f> pixels(body_->rest.vertices.size());
      for (size_t n = begin; n < end; ++n) {
        const auto vertices = skin_vertices(*body_, poses_[n]);
        for (size_t c = 0; c < kCameras; ++c) {
          project_vertices(views_.cameras[c], vertices, pixels);
          draw(renderer, pixels, n * kCameras + c);
        }
      }
    });
  }

  [[nodiscard]] long long sum_of_differing() const {
    long long sum = 0;
    for (const int64_t value : differing_) sum += value;
    return sum;
  }

  std::shared_ptr<const BodyModel> body_;
  const Views views_;
  EdgeTopology topology_;
  std::vector<std::vector<double>> poses_;  // [N]
  std::vector<Mask> references_;            // [N * C]
  std::vector<int64_t> differing_;          // [N * C] pixels
};

}  // namespace

Agreement measure_agreement(const std::shared_ptr<const BodyModel>& body, size_t num_poses) {
  Trial trial(body, num_poses);
  Agreement agreement;
  agreement.pixels = trial.num_pixels();
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    agreement.from_pixels = std::max(agreement.from_pixels, trial.differing_from_pixels());
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  agreement.from_poses = trial.differing_from_poses();
  return agreement;
}

}  // namespace silpose::bench
