// PoseProjector: from poses to points on a window's grid: ProjectedSkin's, in its slots, unless some of the body is too
// near to be visible. In that rare case the reference's vertices are used and the faces cut (projected_mesh.h).
// Threads: constant after construction; one Scratch per thread.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "silpose/render/projected_mesh.h"
#include "silpose/render/projected_skin.h"

namespace silpose {

class PoseProjector {
 public:
  PoseProjector(std::shared_ptr<const BodyModel> body, const PinholeCamera& camera);
  PoseProjector(const PoseProjector&) = delete;  // the skin refers to its neighbouring members
  PoseProjector& operator=(const PoseProjector&) = delete;

  [[nodiscard]] const BodyModel& body() const { return *body_; }
  [[nodiscard]] const PinholeCamera& camera() const { return camera_; }
  [[nodiscard]] std::span<const Face> faces() const { return skin_.faces(); }

  class Scratch {
   public:
    [[nodiscard]] std::span<const GridPoint> points() const { return projected_.points; }
    [[nodiscard]] bool some_unseen() const { return projected_.some_unseen; }
    // What replaces faces that cross the near plane.
    [[nodiscard]] std::span<const Face> cut_faces() const {
      return some_unseen() ? std::span<const Face>(cut_.cut_faces) : std::span<const Face>();
    }
    [[nodiscard]] const PixelBounds& bounds() const { return projected_.bounds; }

   private:
    friend class PoseProjector;
    ProjectedSkin::Scratch projected_;
    ProjectedMesh cut_;  // only where some is unseen, as the next
    std::vector<Eigen::Vector3f> vertices_in_world_;
  };

  // To pixels: bounds() are known then. False when nothing is seen, or when the pose has a number that is not finite.
  bool project(std::span<const double> pose, Scratch& scratch) const;
  // From pixels to a window's grid: points() are known then.
  void round(const Window& window, Scratch& scratch) const;
  // Both, for a window that is known beforehand; bounds() mean nothing.
  bool project_to_grid(std::span<const double> pose, const Window& window, Scratch& scratch) const;

  // 1 / depth of all points() after project(); undefined for unseen points.
  void inverse_depths(const Scratch& scratch, std::vector<float>& inverse_depth) const;

 private:
  void cut(std::span<const double> pose, Scratch& scratch) const;

  std::shared_ptr<const BodyModel> body_;
  PinholeCamera camera_;
  ProjectedSkin skin_;
};

}  // namespace silpose
