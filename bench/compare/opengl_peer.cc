#include <fmt/format.h>
#include <malloc.h>

#include <array>
#include <exception>
#include <thread>

#include "compare/opengl_tiles.h"
#include "compare/peer.h"
#include "silpose/image/image.h"

namespace silpose::bench {
namespace {

// Tried and not faster on any of these: one instanced draw into the layers of an array texture, a stencil or an
// RGBA8 target, 64 tiles. Without culling and the order of the vertex cache all take twice as long.
constexpr std::array kSetups = {
    OpenGlSetup{"1 context, filled by 2 threads, 16 tiles", 1, "2", 4},
    OpenGlSetup{"1 context, filled by 1 thread, 1 tile", 1, "1", 1},
    OpenGlSetup{"2 contexts, filled by themselves, 1 tile", 2, "0", 1},
    OpenGlSetup{"2 contexts, filled by themselves, 16 tiles", 2, "0", 4},
    OpenGlSetup{"2 contexts, filled by 1 thread each, 4 tiles", 2, "1", 2},
};

class OpenGlPeer : public Peer {
 public:
  OpenGlPeer(const SilhouetteScene& scene, const OpenGlSetup& setup) : setup_(&setup) {
    for (int i = 0; i < setup.num_contexts; ++i) contexts_.push_back(std::make_unique<OpenGlTiles>(scene, setup, i));
  }

  [[nodiscard]] std::string name() const override { return fmt::format("OpenGL on llvmpipe, {}", setup_->name); }

  std::vector<int64_t> distances(size_t first, size_t count, const Mask& observed) override {
    const ByteImage bytes = image_from_mask(observed);
    std::vector<int64_t> out(count);
    std::vector<std::exception_ptr> failures(contexts_.size());
    std::vector<std::thread> threads;
    for (size_t c = 0; c < contexts_.size(); ++c) {
      threads.emplace_back([&, c] {
        const size_t begin = count * c / contexts_.size(), end = count * (c + 1) / contexts_.size();
        try {
          contexts_[c]->distances(first + begin, bytes.pixels(), std::span(out).subspan(begin, end - begin));
        } catch (...) {
          failures[c] = std::current_exception();
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (const std::exception_ptr& failure : failures) {
      if (failure) std::rethrow_exception(failure);
    }
    return out;
  }

 private:
  const OpenGlSetup* setup_;
  std::vector<std::unique_ptr<OpenGlTiles>> contexts_;
};

}  // namespace

std::unique_ptr<Peer> make_opengl_peer(const SilhouetteScene& scene) {
  // The driver frees and reallocates its buffers batch by batch. If they were returned to the system each time, a third
  // of its time would go into page faults.
  mallopt(M_MMAP_THRESHOLD, 1 << 25);  // bytes; the largest that is taken
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  return fastest_of(
      std::span<const OpenGlSetup>(kSetups), scene,
      [&](const OpenGlSetup& setup) -> std::unique_ptr<Peer> { return std::make_unique<OpenGlPeer>(scene, setup); });
}

}  // namespace silpose::bench
