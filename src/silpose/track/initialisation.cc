#include "silpose/track/initialisation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"

namespace silpose {
namespace {

struct Blob {
  double area = 0;
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();  // raster pixels
};

Blob measure(const Mask& mask) {
  Blob blob;
  for (int y = 0; y < mask.height(); ++y) {
    const auto row = mask.row(y);
    for (size_t w = 0; w < row.size(); ++w) {
      for (uint64_t bits = row[w]; bits != 0; bits &= bits - 1) {
        blob.area += 1;
        blob.centroid += Eigen::Vector2d(static_cast<double>(w) * 64 + std::countr_zero(bits) + 0.5, y + 0.5);
      }
    }
  }
  if (blob.area > 0) blob.centroid /= blob.area;
  return blob;
}

Eigen::Vector2d image_from_raster(const Window& window, const Eigen::Vector2d& x) {
  return {window.x0 + x.x() / window.scale_x, window.y0 + x.y() / window.scale_y};
}

// Steepest ascent scaled by each DOF's own step, with a line search over whole batches; steps shrink when none gains.
class Descent {
 public:
  Descent(const SilhouetteLikelihood& likelihood, const Evidence& evidence, const InitialisationOptions& options)
      : likelihood_(likelihood), evidence_(evidence), options_(options), skeleton_(likelihood.body().skeleton) {}

  StartingPose run(const Eigen::RowVectorXd& start) const {
    const auto num_dofs = static_cast<Eigen::Index>(skeleton_.num_dofs());
    Eigen::RowVectorXd pose = start;
    double value = evaluate(pose, start)[0];
    double shrink = 1;
    Eigen::VectorXd steps(num_dofs);
    for (int iteration = 0; iteration < options_.num_iterations && shrink > 0.1; ++iteration) {
      for (Eigen::Index d = 0; d < num_dofs; ++d) {
        steps[d] = shrink * (skeleton_.dofs()[d].is_translation ? 0.04 : to_radians(8));
      }
      const auto derivative = likelihood_.derivative(evidence_, {pose.data(), static_cast<size_t>(num_dofs)},
                                                     {steps.data(), static_cast<size_t>(num_dofs)});
      Eigen::RowVectorXd direction(num_dofs);
      for (Eigen::Index d = 0; d < num_dofs; ++d) {
        direction[d] = (derivative.gradient[d] - pull_gradient(pose, start, d)) * steps[d] * steps[d];
      }
      const double length = direction.transpose().cwiseQuotient(steps).cwiseAbs().maxCoeff();
      if (!(length > 0)) break;
      StateBatch trials = pose.replicate(kNumTrials, 1);
      for (Eigen::Index k = 0; k < kNumTrials; ++k) {
        trials.row(k) += direction * (0.25 * std::pow(1.7, static_cast<double>(k)) / length);
        skeleton_.clamp({trials.row(k).data(), static_cast<size_t>(num_dofs)});
      }
      const std::vector<double> values = evaluate(trials, start);
      const auto best = std::max_element(values.begin(), values.end());
      if (*best > value) {
        value = *best;
        pose = trials.row(best - values.begin());
      } else {
        shrink *= 0.6;
      }
    }
    return {{pose.data(), pose.data() + num_dofs}, value};
  }

 private:
  static constexpr Eigen::Index kNumTrials = 8;

  double pull_scale(Eigen::Index d) const {
    const Dof& dof = skeleton_.dofs()[d];
    return dof.is_translation || dof.is_periodic ? 0 : 1 / (0.1 * (dof.upper - dof.lower));
  }
  double pull_gradient(const Eigen::RowVectorXd& pose, const Eigen::RowVectorXd& start, Eigen::Index d) const {
    const double scale = pull_scale(d);
    return 2 * options_.pull / static_cast<double>(pose.size()) * scale * scale * (pose[d] - start[d]);
  }
  std::vector<double> evaluate(const StateBatch& poses, const Eigen::RowVectorXd& start) const {
    std::vector<double> values(static_cast<size_t>(poses.rows()));
    likelihood_.log_likelihood(evidence_, poses, values);
    for (Eigen::Index n = 0; n < poses.rows(); ++n) {
      double off = 0;
      for (Eigen::Index d = 0; d < poses.cols(); ++d) {
        const double scaled = pull_scale(d) * (poses(n, d) - start[d]);
        off += scaled * scaled;
      }
      values[static_cast<size_t>(n)] -= options_.pull * off / static_cast<double>(poses.cols());
    }
    return values;
  }

  const SilhouetteLikelihood& likelihood_;
  const Evidence& evidence_;
  const InitialisationOptions& options_;
  const Skeleton& skeleton_;
};

}  // namespace

StateBatch place_on_mask(const SilhouetteLikelihood& likelihood, const Evidence& evidence,
                         const StateBatch& candidates) {
  const auto seen =
      std::find_if(evidence.views.begin(), evidence.views.end(), [](const auto& view) { return view.trust > 0; });
  check(seen != evidence.views.end(), "place_on_mask: no camera has a say");
  const BatchRenderer& renderer = *likelihood.renderers()[static_cast<size_t>(seen - evidence.views.begin())];
  const BodyModel& body = renderer.body();
  const PinholeCamera& camera = renderer.camera();
  const Window& window = seen->window;
  const Blob observed = measure(seen->observed);
  const Eigen::Vector2d target = image_from_raster(window, observed.centroid);
  const EdgeTopology topology(body.rest.faces);

  StateBatch placed = candidates;
  parallel_for(static_cast<size_t>(placed.rows()), 1, [&](size_t begin, size_t end) {
    OutlineRenderer outline(topology);
    Mask mask(window.width, window.height);
    std::vector<Eigen::Vector2f> pixels(body.rest.vertices.size());
    for (size_t k = begin; k < end; ++k) {
      auto row = placed.row(static_cast<Eigen::Index>(k));
      const std::span<double> pose(row.data(), static_cast<size_t>(body.skeleton.num_dofs()));
      // Depth first from a body of average proportions: an upright body covers about a tenth of its height squared.
      double depth = 0.32 * body.height_m * std::sqrt(camera.fx * camera.fy) * window.scale_x / std::sqrt(observed.area);
      Eigen::Vector2d aim = target;
      for (int iteration = 0; iteration < 5; ++iteration) {
        const Eigen::Vector3d root =
            camera.cam_from_world.inverse() * Eigen::Vector3d(camera.ray_from_pixel(aim) * depth);
        std::copy_n(root.data(), 3, pose.begin());
        project_vertices(camera, skin_vertices(body, pose), pixels);
        outline.draw(pixels, window, mask);
        const Blob drawn = measure(mask);
        if (drawn.area < 1) break;
        depth *= std::clamp(std::sqrt(drawn.area / observed.area), 0.5, 2.0);
        aim += target - image_from_raster(window, drawn.centroid);
      }
    }
  });
  return placed;
}

std::vector<StartingPose> initialise(const SilhouetteLikelihood& likelihood, const Evidence& evidence,
                                     const StateBatch& candidates, const InitialisationOptions& options) {
  check(candidates.rows() > 0, "initialise: no candidates");
  check(likelihood.options().comparison == Comparison::kImage, "initialise: needs a likelihood on the whole image");
  const StateBatch placed = place_on_mask(likelihood, evidence, candidates);
  std::vector<double> values(static_cast<size_t>(placed.rows()));
  likelihood.log_likelihood(evidence, placed, values);
  std::vector<size_t> order(values.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return values[a] > values[b]; });
  order.resize(std::min(order.size(), static_cast<size_t>(options.num_descended)));

  std::vector<StartingPose> starts(order.size());
  const Descent descent(likelihood, evidence, options);
  parallel_for(order.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) starts[i] = descent.run(placed.row(static_cast<Eigen::Index>(order[i])));
  });
  std::stable_sort(starts.begin(), starts.end(),
                   [](const auto& a, const auto& b) { return a.log_likelihood > b.log_likelihood; });
  return starts;
}

}  // namespace silpose
