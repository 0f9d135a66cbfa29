// Peer: a well-maintained third-party pipeline that does the same work as our batch renderer, as well as we can set it
// up. Threads: one at a time; works on both cores itself.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "silhouette_scene.h"
#include "silpose/base/clock.h"

namespace silpose::bench {

class Peer {
 public:
  virtual ~Peer() = default;

  // The pipeline and how it is set up.
  [[nodiscard]] virtual std::string name() const = 0;

  // Differing pixels of `count` poses of the scene from number `first` on and `observed`. [count]
  virtual std::vector<int64_t> distances(size_t first, size_t count, const Mask& observed) = 0;
};

// Of the peers that make(setup) makes, one at a time, the fastest on the scene's first poses. REQUIRES: setups.
template <class Setup, class Make>
std::unique_ptr<Peer> fastest_of(std::span<const Setup> setups, const SilhouetteScene& scene, const Make& make) {
  constexpr size_t kPoses = 64;
  constexpr int kTries = 3;
  const Setup* fastest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Setup& setup : setups) {
    const std::unique_ptr<Peer> peer = make(setup);
    for (int i = 0; i <= kTries; ++i) {
      const Stopwatch stopwatch;
      (void)peer->distances(0, std::min(kPoses, scene.num_poses), scene.observed);
      const double seconds = stopwatch.seconds();
      if (i == 0 || seconds >= least) continue;  // the first is to warm up
      least = seconds;
      fastest = &setup;
    }
  }
  return make(*fastest);
}

// Each tries several set-ups on the scene, which must outlive it, and keeps the fastest.
// Errors: throws std::runtime_error where the pipeline does not start.
std::unique_ptr<Peer> make_opengl_peer(const SilhouetteScene& scene);
std::unique_ptr<Peer> make_embree_peer(const SilhouetteScene& scene);

// Those that this program was built with and that start; says on stderr which are missing.
std::vector<std::unique_ptr<Peer>> make_peers(const SilhouetteScene& scene);

}  // namespace silpose::bench
