#include <cmath>
#include <string>
#include <vector>

#include "benches.h"
#include "silhouette_scene.h"
#include "silpose/base/parallel.h"
#include "silpose/render/depth_renderer.h"
#include "silpose/render/shaded.h"
#include "silpose/shape/distance.h"

namespace silpose::bench {

Figure depth_full(int rounds) {
  constexpr size_t kPoses = 512, kShare = kPoses / 8;
  constexpr double kMissing = 0.5;  // metres
  const SilhouetteScene scene = standing_scene(human(), kPoses);
  const auto plain = [&](size_t n) {
    return draw_depth(scene.camera, skin_vertices(*scene.body, scene.pose(n)), scene.body->rest.faces, scene.window);
  };
  const Image<float> observed = plain(kPoses);
  const DepthRenderer renderer(scene.body, scene.camera);
  std::vector<double> ours(kPoses), theirs(kShare);
  const auto draw_ours = [&] { renderer.distances(scene.batch(kPoses), scene.window, observed, kMissing, ours); };
  const auto draw_theirs = [&] {
    parallel_for(kShare, 8, [&](size_t begin, size_t end) {
      for (size_t n = begin; n < end; ++n) theirs[n] = depth_ssd(plain(n), observed, kMissing);
    });
  };
  draw_ours();
  draw_theirs();
  constexpr double kPixels = 8 * kMissing * kMissing;  // of the outline may differ, by the rounding of floats
  for (size_t n = 0; n < kShare; ++n) {
    verify(std::abs(ours[n] - theirs[n]) <= kPixels + 1e-3 * theirs[n], "depth of pose " + std::to_string(n));
    verify(theirs[n] > 100 * kMissing * kMissing, "depths are too near to be of random poses");
  }
  const Contestant peer{.name = "plain renderer", .amount = kShare, .run = draw_theirs};
  return measure({.unit = "poses/s", .rounds = rounds}, {.name = "ours", .amount = kPoses, .run = draw_ours},
                 std::span(&peer, 1));
}

}  // namespace silpose::bench
