// Silhouettes of posed meshes: from vertices in pixels to a Mask. Two ways that agree to the pixel: a plain reference
// (every triangle filled) and the fast one (winding number of the outline only).
// A pixel is set when its centre lies in some projected triangle (half-open: centres on a left or top edge are inside).
// Shared rule for both: vertices are rounded to a grid of 1/256 raster pixel first (raster_grid.h). A triangle that
// crosses the near plane is cut there (projected_mesh.h): drawn are the triangles of `faces` that lie beyond it, and
// those of `cut_faces`; one with a vertex that is NaN is left out.
// Threads: OutlineRenderer's scratch belongs to one thread; the rest are pure functions.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/geometry/mesh.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/render/strip_order.h"
#include "silpose/shape/window.h"

namespace silpose {

// Which face lies across each edge of each face; made once per mesh. Neighbours run along their edge in opposite
// directions; where more than two faces meet they are paired as far as they go. A missing neighbour is -1.
struct EdgeTopology {
  explicit EdgeTopology(std::span<const Face> faces);
  std::vector<Face> faces;                        // [F]
  std::vector<std::array<int32_t, 3>> neighbour;  // [F] across edges (0,1), (1,2), (2,0)

  // Every edge once: from `vertices[0]` to `vertices[1]` along faces[0], the other way along faces[1]; F means none.
  struct Edges {
    std::vector<std::array<uint32_t, 2>> vertices, faces;
  } edges;
  uint32_t num_vertices = 0;  // largest index + 1
  StripOrder strips;
};

// Vertices [V] in world coordinates to image pixels [V]; vertices nearer than kNear become NaN.
void project_vertices(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
                      std::span<Eigen::Vector2f> pixels);

// The reference: the union of all triangles, each filled by itself.
void draw_silhouette_reference(std::span<const Eigen::Vector2f> pixels, std::span<const Face> faces,
                               const Window& window, Mask& mask, std::span<const Face> cut_faces = {});

// How much of each pixel the silhouette covers, 0 to kFullCoverage (window.h): the reference drawn finer.
[[nodiscard]] ByteImage draw_coverage_reference(std::span<const Eigen::Vector2f> pixels, std::span<const Face> faces,
                                                const Window& window, std::span<const Face> cut_faces = {});

// Smallest image box around the projected vertices that are seen; nothing when there is none.
std::optional<PixelBounds> pixel_bounds(std::span<const Eigen::Vector2f> pixels);

// The fast renderer. Source: non-zero winding rule; every triangle turned to face the camera adds +-1 along the edges
// whose neighbour faces away or is missing; crossings are summed down the columns.
class OutlineRenderer {
 public:
  explicit OutlineRenderer(const EdgeTopology& topology);  // keeps a reference
  OutlineRenderer(OutlineRenderer&&) noexcept;
  ~OutlineRenderer();

  // Pixels: the topology's vertices, then those that only `cut_faces` name.
  void draw(std::span<const Eigen::Vector2f> pixels, const Window& window, Mask& mask,
            std::span<const Face> cut_faces = {});

  // Counts of a drawn silhouette against an observed mask of the window's size, without keeping the drawing.
  struct Counts {
    int64_t model = 0;  // pixels of the silhouette
    int64_t both = 0;   // pixels set in both
  };
  Counts count(std::span<const Eigen::Vector2f> pixels, const Window& window, const Mask& observed,
               std::span<const Face> cut_faces = {});
  // The same of coverages, in samples: the sum of the model's, and of the lesser of both pixel by pixel. `observed`: up
  // to kFullCoverage, of the window's size.
  Counts count_coverage(std::span<const Eigen::Vector2f> pixels, const Window& window, const ByteImage& observed,
                        std::span<const Face> cut_faces = {});

 private:
  void scan(std::span<const Eigen::Vector2f> pixels, const Window& window, std::span<const Face> cut_faces);
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

// A batch: poses [N, D] (row-major) to counts against one observed mask of the window's size. The window is in image
// pixels of `camera`. Runs on all cores (base/parallel.h); the result does not depend on how many.
struct BatchView {
  const double* data;
  size_t num_poses, num_dofs, stride;  // row n at data + n * stride
};
class BatchRenderer {
 public:
  BatchRenderer(std::shared_ptr<const BodyModel> body, const PinholeCamera& camera);
  // Poses with a number that is not finite count {0, 0}. REQUIRES: equal sizes of window, mask and `out`; num_dofs = D.
  void counts(const BatchView& poses, const Window& window, const Mask& observed,
              std::span<OutlineRenderer::Counts> out) const;
  // The same of coverages, as OutlineRenderer::count_coverage().
  void coverages(const BatchView& poses, const Window& window, const ByteImage& observed,
                 std::span<OutlineRenderer::Counts> out) const;
  // Each silhouette cropped to the bounding box of its part inside the image and scaled to the observed mask's size
  // (see shape/normalised_silhouette.h), then compared. An unseen body counts {0, 0}.
  void counts_cropped(const BatchView& poses, const Mask& observed_cropped,
                      std::span<OutlineRenderer::Counts> out) const;
  void coverages_cropped(const BatchView& poses, const ByteImage& observed_cropped,
                         std::span<OutlineRenderer::Counts> out) const;
  // The silhouettes themselves, each of the window's size: [N]. A pose that is not seen has none of its pixels set.
  void silhouettes(const BatchView& poses, const Window& window, std::span<Mask> out) const;
  // Cropped as by counts_cropped(), width x height pixels each: [N].
  void silhouettes_cropped(const BatchView& poses, int width, int height, std::span<Mask> out) const;
  // One pose [D] over the whole image.
  [[nodiscard]] Mask silhouette(std::span<const double> pose) const;

  [[nodiscard]] const BodyModel& body() const;
  [[nodiscard]] const PinholeCamera& camera() const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

// One pose over the whole image, by the reference: what reports and `evaluate` compare.
Mask render_silhouette(const BodyModel& body, const PinholeCamera& camera, std::span<const double> pose);

}  // namespace silpose
