// Embree: the skinned mesh's BVH is refitted or rebuilt for each pose, then one ray per pixel tests whether it hits
// anything. A pose is one thread's work.
#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "compare/peer.h"
#include "figure.h"
#include "silpose/base/clock.h"
#include "silpose/base/parallel.h"

namespace silpose::bench {
namespace {

struct Setup {
  const char* name;
  RTCBuildQuality scene, geometry;
  bool robust;
};
constexpr std::array kSetups = {
    Setup{"BVH refitted", RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_REFIT, false},
    Setup{"BVH rebuilt, low quality", RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_LOW, false},
    Setup{"BVH rebuilt, medium quality", RTC_BUILD_QUALITY_MEDIUM, RTC_BUILD_QUALITY_MEDIUM, false},
};

// What one thread works with.
class Caster {
 public:
  Caster(RTCDevice device, const SilhouetteScene& scene, const Setup& setup)
      : scene_(&scene),
        clip_from_rest_(static_cast<size_t>(scene.body->skeleton.num_joints())),
        silhouette_(scene.window.width, scene.window.height) {
    const Mesh& mesh = scene.body->rest;
    mesh_ = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    vertices_ = static_cast<float*>(rtcSetNewGeometryBuffer(mesh_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                            3 * sizeof(float), mesh.vertices.size()));
    auto* faces = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(mesh_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(uint32_t), mesh.faces.size()));
    for (const Face& face : mesh.faces) faces = std::ranges::copy(face, faces).out;
    rtcSetGeometryBuildQuality(mesh_, setup.geometry);
    bvh_ = rtcNewScene(device);
    rtcSetSceneBuildQuality(bvh_, setup.scene);
    rtcSetSceneFlags(bvh_, setup.robust ? RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_DYNAMIC);
    rtcAttachGeometry(bvh_, mesh_);
  }
  Caster(const Caster&) = delete;
  Caster& operator=(const Caster&) = delete;
  ~Caster() {
    rtcReleaseScene(bvh_);
    rtcReleaseGeometry(mesh_);
  }

  int64_t distance(std::span<const double> pose, const Mask& observed) {
    skin(pose);
    rtcUpdateGeometryBuffer(mesh_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(mesh_);
    rtcCommitScene(bvh_);
    cast();
    return xor_count(silhouette_, observed);
  }

 private:
  static constexpr int kBlock = 4;  // pixels a side: 16 rays at a time

  // Into clip coordinates; x_min_ to y_max_ are the bounds on the image in pixels.
  void skin(std::span<const double> pose) {
    clip_from_rest(*scene_, pose, clip_from_rest_);
    const SkinWeights& weights = scene_->body->skin;
    const auto& rest = scene_->body->rest.vertices;
    float x0 = 1, x1 = -1, y0 = 1, y1 = -1;
    for (size_t v = 0; v < rest.size(); ++v) {
      ClipFromRest blended = ClipFromRest::Zero();
      for (uint32_t i = weights.row_start[v]; i < weights.row_start[v + 1]; ++i) {
        blended += weights.weight[i] * clip_from_rest_[weights.joint_idx[i]];
      }
      const Eigen::Vector3f x = blended.leftCols<3>() * rest[v] + blended.col(3);
      std::copy_n(x.data(), 3, vertices_ + 3 * v);
      const float inverse = 1 / x.z();
      x0 = std::min(x0, x.x() * inverse);
      x1 = std::max(x1, x.x() * inverse);
      y0 = std::min(y0, x.y() * inverse);
      y1 = std::max(y1, x.y() * inverse);
    }
    const auto pixel = [](float clip, int size) {
      return std::clamp(static_cast<int>((clip + 1) * static_cast<float>(size) / 2), 0, size);
    };
    x_begin_ = pixel(x0, silhouette_.width()) / kBlock;
    y_begin_ = pixel(y0, silhouette_.height()) / kBlock;
    x_end_ = (pixel(x1, silhouette_.width()) + kBlock) / kBlock;
    y_end_ = (pixel(y1, silhouette_.height()) + kBlock) / kBlock;
  }

  void cast() {
    silhouette_.clear();
    const int width = silhouette_.width(), height = silhouette_.height();
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(64) RTCRay16 rays{};
    alignas(64) std::array<int, 16> valid;
    for (int by = y_begin_; by < y_end_; ++by) {
      for (int bx = x_begin_; bx < x_end_; ++bx) {
        for (int i = 0; i < 16; ++i) {
          const int x = kBlock * bx + i % kBlock, y = kBlock * by + i / kBlock;
          valid[static_cast<size_t>(i)] = x < width && y < height ? -1 : 0;
          rays.dir_x[i] = (2 * static_cast<float>(x) + 1) / static_cast<float>(width) - 1;
          rays.dir_y[i] = (2 * static_cast<float>(y) + 1) / static_cast<float>(height) - 1;
          rays.dir_z[i] = 1;
          rays.tnear[i] = 0;
          rays.tfar[i] = INFINITY;
          rays.mask[i] = ~0u;
        }
        rtcOccluded16(valid.data(), bvh_, &context, &rays);
        for (int i = 0; i < 16; ++i) {  // a hit leaves -infinity
          if (valid[static_cast<size_t>(i)] != 0 && rays.tfar[i] < 0) {
            silhouette_.set(kBlock * bx + i % kBlock, kBlock * by + i / kBlock);
          }
        }
      }
    }
  }

  const SilhouetteScene* scene_;
  std::vector<ClipFromRest> clip_from_rest_;  // [J]
  Mask silhouette_;
  RTCGeometry mesh_ = nullptr;
  RTCScene bvh_ = nullptr;
  float* vertices_ = nullptr;                              // [V, 3]
  int x_begin_ = 0, x_end_ = 0, y_begin_ = 0, y_end_ = 0;  // blocks that hold the body
};

class EmbreePeer : public Peer {
 public:
  EmbreePeer(const SilhouetteScene& scene, const Setup& setup) : scene_(&scene), setup_(&setup) {
    device_ = rtcNewDevice(nullptr);
    if (device_ == nullptr) throw std::runtime_error("Embree does not start");
    for (int i = 0; i < kThreads; ++i) casters_.push_back(std::make_unique<Caster>(device_, scene, setup));
  }
  EmbreePeer(const EmbreePeer&) = delete;
  EmbreePeer& operator=(const EmbreePeer&) = delete;
  ~EmbreePeer() override {
    casters_.clear();
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] std::string name() const override {
    return fmt::format("Embree {}, 16 rays at a time, {}, {} threads", RTC_VERSION_STRING, setup_->name, kThreads);
  }

  std::vector<int64_t> distances(size_t first, size_t count, const Mask& observed) override {
    std::vector<int64_t> out(count);
    std::vector<std::jthread> threads;
    for (size_t t = 0; t < casters_.size(); ++t) {
      threads.emplace_back([&, t] {
        for (size_t n = t; n < count; n += casters_.size()) {
          out[n] = casters_[t]->distance(scene_->pose(first + n), observed);
        }
      });
    }
    threads.clear();
    return out;
  }

 private:
  static constexpr int kThreads = 2;
  const SilhouetteScene* scene_;
  const Setup* setup_;
  RTCDevice device_ = nullptr;
  std::vector<std::unique_ptr<Caster>> casters_;
};

}  // namespace

std::unique_ptr<Peer> make_embree_peer(const SilhouetteScene& scene) {
  return fastest_of(std::span<const Setup>(kSetups), scene, [&](const Setup& setup) -> std::unique_ptr<Peer> {
    return std::make_unique<EmbreePeer>(scene, setup);
  });
}

}  // namespace silpose::bench
