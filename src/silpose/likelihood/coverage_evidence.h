// CoverageEvidence: what CoverageLikelihood compares a pose with: the observations of one instant as covered cells and
// keypoints, and how noisy they are.
// Threads: values; functions without state.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "silpose/base/aligned_floats.h"
#include "silpose/body/skeleton.h"
#include "silpose/image/mask.h"
#include "silpose/likelihood/keypoint_term.h"
#include "silpose/likelihood/pose_likelihood.h"

namespace silpose {

// How wide the blur is: sigma, in pixels of a subject who is kSubjectHeight pixels tall; it scales with the subject.
// [definition]
enum class Blur { k2 = 0, k4, k8, k16, k32 };
inline constexpr std::array<int, 5> kBlurSigma = {2, 4, 8, 16, 32};

// The observations of one instant, as covered cells and keypoints.
struct CoverageEvidence : PoseLikelihood::Evidence {
  static constexpr double kSubjectHeight = 280;  // pixels
  struct Raster {
    int cell = 0;                   // pixels a side
    int width = 0, height = 0;      // cells
    std::vector<float> observed;    // by at(): covered part, 0 to 1
    std::vector<float> confidence;  // the same; empty: 1 everywhere
    Box occupied;                   // cells with anything observed
    // Column by column; below each column are zeros, as many as a vector register may read beyond it.
    [[nodiscard]] size_t stride() const { return static_cast<size_t>(height) + AlignedFloats::kLanes; }
    [[nodiscard]] size_t at(int x, int y) const { return static_cast<size_t>(x) * stride() + static_cast<size_t>(y); }
  };
  struct View {
    double trust = 0;                               // 0: this camera is ignored
    double pixel_unit = 1;                          // pixels that one pixel of a subject of kSubjectHeight is worth
    double outline_length = 0;                      // pixels, of the observed mask
    std::array<Raster, kBlurSigma.size()> rasters;  // by Blur
    std::shared_ptr<const KeypointTerm> keypoints;  // null: none
  };
  std::vector<View> views;    // [C]
  std::vector<double> noise;  // [C] outline variance times correlation length, px^3; may be set by the caller
  bool silhouettes = true;    // whether they are used
  // Of the likelihood's further terms.
  struct Term {
    std::shared_ptr<const PoseLikelihood> likelihood;
    std::shared_ptr<const PoseLikelihood::Evidence> evidence;
  };
  std::vector<Term> terms;

  // Sets the noise of the cameras that have one, in units of pixel_unit^3 (as estimate_noise() gives it). [C], or
  // empty.
  void set_noise(std::span<const double> relative);
  [[nodiscard]] double relative_noise(size_t camera_idx) const;

  // The first camera that is used; nothing where none is.
  [[nodiscard]] std::optional<size_t> first_seen() const;

  // Whether any camera's directions in space are used.
  [[nodiscard]] bool has_directions() const;
  // Cost of the keypoints alone. `skeleton` is that of the body, or of one made stretchable.
  [[nodiscard]] double keypoint_cost(const Skeleton& skeleton, std::span<const double> pose) const;
  // E of the further terms alone. A pose may have more numbers than the terms' bodies have DOF; the first count.
  [[nodiscard]] double energy_of_terms(std::span<const double> pose) const;
  // The same; adds to `gradient` [D' >= D] and `hessian` [D', D'] of half of it.
  double add_terms(std::span<const double> pose, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const;
};

// Length of a mask's outline in pixels, by counting the borders between set and unset pixels (corrected for the steps
// of slanting lines: isotropic outlines come out right on average). The image's own border does not count.
double outline_length(const Observation& observation);

}  // namespace silpose
