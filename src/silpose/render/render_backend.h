// RenderBackend: draws a body before one camera for batches of poses. Likelihoods compare what it draws with what was
// observed.
//
// Contract: silhouettes are those of the plain reference (silhouette.h) but for the rounding of projected vertices to
// 1/256 raster pixel; depths those of draw_depth() (shaded.h) but for single precision. A pose with a number that is
// not finite, or that is not seen, shows nothing. A pose's result depends neither on the rest of the batch nor on the
// number of threads. The fused calls return false and write nothing where a backend does not have them; where it does,
// they give what drawing and then counting would.
// Threads: constant after construction; any thread may call.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/window.h"

namespace silpose {

// What of the image is drawn.
struct Framing {
  // Raster and part of the image. Cropped: only its width and height count, and what is drawn is the box around each
  // pose's own silhouette inside the image, stretched to them (shape/normalised_silhouette.h).
  Window window;
  bool cropped = false;
};

class RenderBackend {
 public:
  virtual ~RenderBackend() = default;

  // The object that it was made with.
  [[nodiscard]] virtual const BodyModel& body() const = 0;
  [[nodiscard]] virtual const PinholeCamera& camera() const = 0;

  // Shapes: poses [N, D]; out [N], each of the window's size after the call.
  // Errors, here and below: throws std::invalid_argument for poses of another D and for wrong sizes.
  virtual void silhouettes(const BatchView& poses, const Framing& framing, std::span<Mask> out) const = 0;

  // Metres along the camera's axis, 0 where there is no surface. Shapes: out [N, window.height, window.width].
  virtual void depths(const BatchView& poses, const Window& window, std::span<float> out) const = 0;

  // Fused: the pixels of each silhouette, and those that it shares with `observed`, which has the window's size.
  [[nodiscard]] virtual bool counts(const BatchView& poses, const Framing& framing, const Mask& observed,
                                    std::span<OutlineRenderer::Counts> out) const;
  // The same in samples (shape/window.h). `observed`: 0 to kFullCoverage, of the window's size.
  [[nodiscard]] virtual bool coverages(const BatchView& poses, const Framing& framing, const ByteImage& observed,
                                       std::span<OutlineRenderer::Counts> out) const;
  // depth_ssd() (shape/distance.h) of each pose's depths and those observed, of the window's size. Shapes: out [N].
  [[nodiscard]] virtual bool depth_distances(const BatchView& poses, const Window& window, const Image<float>& observed,
                                             double missing_m, std::span<double> out) const;
};

// Makes the backend of a body before a camera.
using MakeRenderBackend =
    std::function<std::shared_ptr<const RenderBackend>(std::shared_ptr<const BodyModel>, const PinholeCamera&)>;

// The processor's vector units and all cores; has every fused call. Errors: throws std::invalid_argument without body.
std::shared_ptr<const RenderBackend> make_cpu_backend(std::shared_ptr<const BodyModel> body,
                                                      const PinholeCamera& camera);
// The plain reference, triangle by triangle on one core, for tests and for checking other backends. Nothing is fused.
std::shared_ptr<const RenderBackend> make_reference_backend(std::shared_ptr<const BodyModel> body,
                                                            const PinholeCamera& camera);

}  // namespace silpose
