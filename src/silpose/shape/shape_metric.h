// ShapeMetric: how far silhouettes are from an observed one. A likelihood describes what was observed once, draws
// candidates and asks for their distances; where areas alone matter (AreaMetric), renderers count while they draw.
//
// Contract: distances are finite and not negative. The observed silhouette itself, if it is not empty, has the least
// distance, which is 0 where the window has the image's own pixels. Every silhouette has a distance, the empty one too.
// A distance depends neither on the other silhouettes of the batch nor on the number of threads.
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

  // The raster on which candidates are drawn to be compared in a window: the window itself, or one that is finer by the
  // same factor for every window.
  [[nodiscard]] virtual Window raster(const Window& window) const { return window; }

  // What is observed in a window, in the form that comparisons need.
  class Description {
   public:
    virtual ~Description() = default;
    // Whether nothing of the subject is left to compare with, as of one that is smaller than a pixel of the window.
    [[nodiscard]] virtual bool is_empty() const { return false; }
  };
  // Shapes: observed, ignored [H, W] of the image, not of the window. Pixels of `ignored` count in no silhouette; null:
  // all count. Errors: throws std::invalid_argument for different sizes.
  [[nodiscard]] virtual std::unique_ptr<const Description> describe(const Mask& observed, const Mask* ignored,
                                                                    const Window& window) const = 0;

  // Shapes: masks [N], each of raster(window)'s size; out [N]. REQUIRES: a description by this metric.
  virtual void distances(const Description& observed, std::span<const Mask> masks, std::span<double> out) const = 0;
};

// A function of areas alone: renderers can count these while they draw. This one is what is in one of two silhouettes
// only, over the sum of both areas: 0 if they are equal, 1 if they are disjoint (two empty ones, too). Another one
// overrides distance().
// Source: cormier2019 eq. 2.4, there not divided by the areas.
class AreaMetric : public ShapeMetric {
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
  [[nodiscard]] virtual double distance(const Areas& areas) const;

  // What renderers count against. The ignored pixels are not in the observed silhouette; what the model has there is
  // counted by itself and left out.
  struct Described final : Description {
    Mask mask, ignored;                    // kPixels: of the window; `ignored` is empty where all count
    ByteImage coverage, ignored_coverage;  // kSamples: of the window, 0 to kFullCoverage; likewise
    int64_t area = 0;                      // of the observed silhouette
    [[nodiscard]] bool is_empty() const override { return area == 0; }
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
