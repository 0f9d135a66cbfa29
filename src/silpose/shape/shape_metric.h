// ShapeMetric: how far silhouettes are from an observed one. A likelihood describes what was observed once, draws
// candidates and asks for their distances; where areas alone matter (AreaMetric), renderers count while they draw.
//
// Contract: distances are finite and not negative. The observed silhouette itself has the least distance, which is 0
// where the window has the image's own pixels. Every silhouette has a distance, the empty one too. A distance depends
// neither on the other silhouettes of the batch nor on the number of threads.
// Source of the idea, and of most metrics: cormier2019 sect. 2.3 (references.bib).
// Threads: metrics are constant; any thread may call.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/shape/window.h"

namespace silpose {

class ShapeMetric {
 public:
  virtual ~ShapeMetric() = default;

  // The raster on which candidates are drawn to be compared in a window: the window itself, or a finer one.
  [[nodiscard]] virtual Window raster(const Window& window) const { return window; }

  // What is observed in a window, in the form that comparisons need.
  class Description {
   public:
    virtual ~Description() = default;
  };
  // Shapes: observed, ignored [H, W] of the image, not of the window. Pixels of `ignored` count in no silhouette; null:
  // all count. Errors: throws std::invalid_argument for different sizes.
  [[nodiscard]] virtual std::unique_ptr<const Description> describe(const Mask& observed, const Mask* ignored,
                                                                    const Window& window) const = 0;

  // Shapes: masks [N], each of raster(window)'s size; out [N]. REQUIRES: a description by this metric.
  virtual void distances(const Description& observed, std::span<const Mask> masks, std::span<double> out) const = 0;
};

// What is in one of two silhouettes only, over the sum of both areas: 0 if they are equal, 1 if they are disjoint (two
// empty ones, too). It is half of the normalised symmetric difference, a metric for sets that are not both empty.
// Source: cormier2019 eq. 2.4, there not divided by the areas.
class AreaMetric final : public ShapeMetric {
 public:
  enum class Unit {
    kPixels,   // whole pixels of the window
    kSamples,  // parts of pixels, in samples (window.h): motion of a tenth of a pixel changes the distance
  };
  explicit AreaMetric(Unit unit) : unit_(unit) {}

  // Pixels or samples in the observed silhouette, in the model's, and in both.
  struct Areas {
    int64_t observed = 0, model = 0, both = 0;
  };
  [[nodiscard]] static double distance(const Areas& areas);

  // What renderers count against. The ignored pixels are not in the observed silhouette; what the model has there is
  // counted by itself and left out.
  struct Described final : Description {
    Mask mask, ignored;                    // kPixels: of the window; `ignored` is empty where all count
    ByteImage coverage, ignored_coverage;  // kSamples: of the window, 0 to kFullCoverage; likewise
    int64_t area = 0;                      // of the observed silhouette
    [[nodiscard]] bool has_ignored() const { return ignored.width() > 0 || !ignored_coverage.empty(); }
  };

  [[nodiscard]] Window raster(const Window& window) const override;
  [[nodiscard]] std::unique_ptr<const Description> describe(const Mask& observed, const Mask* ignored,
                                                            const Window& window) const override;
  void distances(const Description& observed, std::span<const Mask> masks, std::span<double> out) const override;

 private:
  Unit unit_;
};

}  // namespace silpose
