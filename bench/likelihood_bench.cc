#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "agreement.h"
#include "benches.h"
#include "compare/peer.h"
#include "silhouette_scene.h"
#include "silpose/base/clock.h"
#include "silpose/base/parallel.h"

namespace silpose::bench {
namespace {

// Ours and the plain renderer draw the same triangles on the same grid; vertices differ by the rounding of floats
// alone. Others have grids of their own, or none.
constexpr int64_t kTolerance = 4;    // pixels by which a distance may differ
constexpr int64_t kWorstOfPeer = 8;  // pixels of a silhouette
constexpr double kMeanOfPeer = 1;    // pixels of a silhouette

void verify_ours(const SilhouetteScene& scene, const BatchRenderer& renderer) {
  const auto ours = our_distances(scene, renderer, 0, scene.num_poses, scene.observed);
  const auto plain = plain_distances(scene, 0, scene.num_poses, scene.observed);
  int64_t total = 0;
  for (size_t n = 0; n < scene.num_poses; ++n) {
    verify(std::abs(ours[n] - plain[n]) <= kTolerance, "distance of pose " + std::to_string(n));
    total += plain[n];
  }
  verify(total > static_cast<int64_t>(scene.num_poses) * 100, "distances are too small to be of random poses");
}

// Against the plain silhouette of the same pose the distance is the number of pixels that differ.
void verify_peer(const SilhouetteScene& scene, Peer& peer) {
  constexpr size_t kPoses = 32;
  double total = 0;
  for (size_t n = 0; n < kPoses; ++n) {
    const int64_t differing = peer.distances(n, 1, plain_silhouette(scene, scene.pose(n)))[0];
    verify(differing <= kWorstOfPeer, peer.name() + ": silhouette of pose " + std::to_string(n));
    total += static_cast<double>(differing);
  }
  verify(total <= kMeanOfPeer * kPoses, peer.name() + ": silhouettes");
}

Figure likelihood(std::shared_ptr<const BodyModel> body, size_t num_poses, int rounds) {
  const SilhouetteScene scene = standing_scene(std::move(body), num_poses);
  const BatchRenderer renderer(scene.body, scene.camera);
  verify_ours(scene, renderer);
  const std::vector<std::unique_ptr<Peer>> others = make_peers(scene);
  for (const auto& peer : others) verify_peer(scene, *peer);

  // Peers take their time: they get a share of the poses.
  const size_t share = num_poses / 16;
  std::vector<Contestant> peers;
  for (const auto& peer : others) {
    peers.push_back({.name = peer->name(), .amount = static_cast<double>(share), .run = [&scene, &peer, share] {
                       keep(peer->distances(0, share, scene.observed));
                     }});
  }
  peers.push_back({.name = "plain renderer, every triangle filled", .amount = static_cast<double>(share), .run = [&] {
                     keep(plain_distances(scene, 0, share, scene.observed));
                   }});
  const Contestant ours{.name = "ours", .amount = static_cast<double>(num_poses), .run = [&] {
                          keep(our_distances(scene, renderer, 0, num_poses, scene.observed));
                        }};
  return measure({.unit = "poses/s", .rounds = rounds}, ours, peers);
}

}  // namespace

Figure likelihood_full(int rounds) {
  const Agreement agreement = measure_agreement(human(), 1000);
  verify(agreement.from_pixels == 0, "pixels differ from the same projected vertices");
  verify(100'000 * agreement.from_poses <= agreement.pixels,
         "more than a pixel in 100,000 differs from the same poses");
  return likelihood(human(), 1024, rounds);
}
Figure likelihood_lod(int rounds) { return likelihood(level_of_detail(human(), 2000), 4096, rounds); }

Figure likelihood_coverage(int rounds) {
  constexpr size_t kPoses = 1024, kShare = kPoses / 16;
  const SilhouetteScene scene = standing_scene(human(), kPoses);
  const BatchRenderer renderer(scene.body, scene.camera);
  const ByteImage observed = plain_coverage(scene, scene.pose(kPoses));
  std::vector<OutlineRenderer::Counts> counts(kPoses);
  const auto ours = [&] { renderer.coverages(scene.batch(kPoses), scene.window, observed, counts); };
  ours();
  for (size_t n = 0; n < kShare; ++n) {
    OutlineRenderer::Counts plain;
    const ByteImage model = plain_coverage(scene, scene.pose(n));
    for (size_t i = 0; i < model.pixels().size(); ++i) {
      plain.model += model.pixels()[i];
      plain.both += std::min(model.pixels()[i], observed.pixels()[i]);
    }
    verify(std::abs(counts[n].model - plain.model) <= kTolerance * kCoverageSamples &&
               std::abs(counts[n].both - plain.both) <= kTolerance * kCoverageSamples,
           "coverage of pose " + std::to_string(n));
  }
  const Contestant peers[] = {{.name = "plain renderer, every triangle filled",
                               .amount = kShare,
                               .run =
                                   [&] {
                                     parallel_for(kShare, 8, [&](size_t begin, size_t end) {
                                       for (size_t n = begin; n < end; ++n) keep(plain_coverage(scene, scene.pose(n)));
                                     });
                                   }},
                              {.name = "pixel count", .amount = kPoses, .run = [&] {
                                 keep(our_distances(scene, renderer, 0, kPoses, scene.observed));
                               }}};
  return measure({.unit = "poses/s", .rounds = rounds}, {.name = "ours", .amount = kPoses, .run = ours}, peers);
}

Figure scaling_2_threads(int rounds) {
  constexpr size_t kPoses = 2048;
  const SilhouetteScene scene = standing_scene(human(), kPoses);
  const BatchRenderer renderer(scene.body, scene.camera);
  std::vector<int64_t> distances[2];
  const auto seconds_on = [&](int num_threads) {
    const ThreadLimit limit(num_threads);
    const Stopwatch stopwatch;
    distances[num_threads - 1] = our_distances(scene, renderer, 0, kPoses, scene.observed);
    return stopwatch.seconds();
  };
  seconds_on(1);
  seconds_on(2);
  verify(distances[0] == distances[1], "distances depend on the number of threads");
  std::vector<double> ratios;
  for (int round = 0; round < rounds; ++round) {
    const double one = seconds_on(1);
    ratios.push_back(one / seconds_on(2));
  }
  const double median = quantile(ratios, 0.5);
  return {.value = median,
          .unit = "times",
          .spread = (quantile(ratios, 0.75) - quantile(ratios, 0.25)) / median,
          .peers = {{.peer = "one thread", .peer_value = 1, .ratio = median}}};
}

}  // namespace silpose::bench
