// ProjectedSkin: from a pose straight to pixels. Camera and, where the lens is straight, its intrinsics are folded into
// the joint matrices, so that skinning yields homogeneous pixels. Vertices are handled in chunks, sorted by the joints
// that move them; their order ("slots") is therefore not the mesh's, and faces() are given in slots.
// Source: linear blend skinning (references.bib: magnenat1988).
// Threads: constant after construction; one Scratch per thread.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/render/raster_grid.h"
#include "silpose/render/skin_kernels.h"
#include "silpose/shape/window.h"

namespace silpose {

class ProjectedSkin {
 public:
  ProjectedSkin(const BodyModel& body, const PinholeCamera& camera);  // keeps references

  [[nodiscard]] std::span<const Face> faces() const { return faces_; }
  [[nodiscard]] size_t num_slots() const { return kChunkLanes * chunks_.size(); }
  // The mesh's vertex at each slot [slots].
  [[nodiscard]] std::span<const uint32_t> vertex_of_slot() const { return vertex_of_slot_; }

  // What one thread needs, and where project() leaves the pixels.
  struct Scratch {
    std::vector<Rigid3> world_from_joint;
    std::vector<float> matrices;           // [J, 3, 4]
    std::vector<ChunkFloats> x, y, depth;  // [chunks] pixels; x is NaN where unseen
    PixelBounds bounds;                    // of what is seen
    bool some_unseen = false;
    std::vector<GridPoint> points;  // [slots] what round() makes of them
  };

  // Projects a pose [D]. False when nothing is seen, or when the pose has a number that is not finite.
  bool project(std::span<const double> pose, Scratch& scratch) const;

  // The same for a window that is known beforehand: scratch.points is left as round() makes them, unless some vertex is
  // unseen; then they mean nothing.
  bool project_to_grid(std::span<const double> pose, const Window& window, Scratch& scratch) const;

  // The same, to pixels [slots], NaN where unseen, whatever the window; of `scratch` only some_unseen is left.
  bool project_to_pixels(std::span<const double> pose, std::span<Eigen::Vector2f> pixels, Scratch& scratch) const;

  // Rounds the pixels to a window's grid, into scratch.points. REQUIRES: all are seen.
  void round(const Window& window, Scratch& scratch) const;

 private:
  void set_matrices(std::span<const double> pose, Scratch& scratch) const;
  [[nodiscard]] SkinView view(const Scratch& scratch) const;
  bool leave_out_unseen(Scratch& scratch) const;

  const BodyModel* body_;
  const PinholeCamera* camera_;
  std::vector<Face> faces_;
  std::vector<uint32_t> vertex_of_slot_;
  std::vector<SkinChunk> chunks_;
  std::vector<SkinEntry> entries_;
  std::vector<uint32_t> entry_joint_;
};

}  // namespace silpose
