#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "compare/peer.h"

namespace silpose::bench {

std::vector<std::unique_ptr<Peer>> make_peers(const SilhouetteScene& scene) {
  std::vector<std::unique_ptr<Peer>> peers;
  [[maybe_unused]] const auto add = [&](const char* pipeline, auto make) {
    try {
      peers.push_back(make(scene));
    } catch (const std::exception& failure) {
      fmt::print(stderr, "silpose_bench: no {} peer: {}\n", pipeline, failure.what());
    }
  };
#ifdef SILPOSE_BENCH_OPENGL
  add("OpenGL", make_opengl_peer);
#else
  fmt::print(stderr, "silpose_bench: built without OpenGL: no such peer (scripts/install-bench-peers)\n");
#endif
#ifdef SILPOSE_BENCH_EMBREE
  add("Embree", make_embree_peer);
#else
  fmt::print(stderr, "silpose_bench: built without Embree: no such peer (scripts/install-bench-peers)\n");
#endif
  return peers;
}

}  // namespace silpose::bench
