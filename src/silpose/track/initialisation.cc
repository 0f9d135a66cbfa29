#include "silpose/track/initialisation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/filter/adaptive_search.h"
#include "silpose/track/limbs.h"
#include "silpose/track/pose_estimate.h"

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

// How far a pose may be off a candidate: the deviation of the prior about it, and the first step of descent. [D]
std::vector<double> reach(const Skeleton& skeleton) {
  std::vector<double> deviation;
  for (const Dof& dof : skeleton.dofs()) {
    deviation.push_back(dof.is_translation ? 0.1 : dof.is_periodic ? to_radians(15) : 0.12 * (dof.upper - dof.lower));
  }
  return deviation;
}

StateBatch one_state(std::span<const double> pose) {
  return Eigen::Map<const Eigen::RowVectorXd>(pose.data(), std::ssize(pose));
}

// Gradient ascent in which every DOF has a step of its own that grows while the gradient keeps its sign and shrinks
// when it turns: the likelihood's slopes differ by orders of magnitude between DOF. Source: igel2003 (iRprop-).
StartingPose descend(const SilhouetteLikelihood& likelihood, const Evidence& evidence, std::span<const double> start,
                     int num_iterations) {
  const Skeleton& skeleton = likelihood.body().skeleton;
  const std::vector<double> widest = reach(skeleton);
  const size_t D = widest.size();
  std::vector<double> pose(start.begin(), start.end()), steps(D), last_gradient(D, 0), probe(D);
  for (size_t d = 0; d < D; ++d) steps[d] = 0.3 * widest[d];
  StartingPose best{pose, -std::numeric_limits<double>::infinity()};
  for (int iteration = 0; iteration < num_iterations; ++iteration) {
    for (size_t d = 0; d < D; ++d) probe[d] = std::max(0.5 * steps[d], 0.05 * widest[d]);
    const auto derivative = likelihood.derivative(evidence, pose, probe);
    if (derivative.log_likelihood > best.log_likelihood) best = {pose, derivative.log_likelihood};
    for (size_t d = 0; d < D; ++d) {
      double gradient = derivative.gradient[static_cast<Eigen::Index>(d)];
      if (gradient * last_gradient[d] > 0) steps[d] = std::min(1.2 * steps[d], widest[d]);
      if (gradient * last_gradient[d] < 0) {
        steps[d] = std::max(0.5 * steps[d], 0.01 * widest[d]);
        gradient = 0;
      }
      pose[d] += gradient > 0 ? steps[d] : gradient < 0 ? -steps[d] : 0;
      last_gradient[d] = gradient;
    }
    skeleton.clamp(pose);
  }
  return best;
}

// What descent along single DOF leaves: a search that learns how they trade off.
StartingPose polish(const SilhouetteLikelihood& likelihood, const Evidence& evidence, const StartingPose& start,
                    const InitialisationOptions& options, uint64_t stream) {
  const Skeleton& skeleton = likelihood.body().skeleton;
  std::vector<double> deviation = reach(skeleton);
  for (double& width : deviation) width *= 0.5;
  FilterReport report;
  const ParticleSet particles = adaptive_search(
      {start.pose, deviation},
      {.num_particles = options.num_particles, .num_layers = options.num_layers, .seed = options.seed}, stream,
      [&](std::span<double> pose) { skeleton.clamp(pose); },
      [&](const StateBatch& states, std::span<double> out) { likelihood.log_likelihood(evidence, states, out); }, report);
  StartingPose found{pose_estimate(skeleton, particles, Estimate::kMean, deviation), 0};
  likelihood.log_likelihood(evidence, one_state(found.pose), {&found.log_likelihood, 1});
  return found.log_likelihood > start.log_likelihood ? found : start;
}

// Which of eight directions a pose faces, for a skeleton whose root turns about the vertical; else 0.
int heading_sector(const Skeleton& skeleton, std::span<const double> pose) {
  for (int d = 0; d < skeleton.num_dofs(); ++d) {
    const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
    if (dof.joint_idx == 0 && dof.is_periodic && dof.axis.y() > 0.5) {
      return static_cast<int>(std::lround(wrap_angle(pose[static_cast<size_t>(d)]) / (kPi / 4)) + 8) % 8;
    }
  }
  return 0;
}

// Front and back look alike in a silhouette. Where nothing else tells, a person before a camera faces it: 1 when the
// root does, -1 when its back does.
double faces_camera(const BodyModel& body, const PinholeCamera& camera, std::span<const double> pose) {
  const Rigid3 root = body.skeleton.forward_kinematics(pose).front();
  return (root.rotation * Eigen::Vector3d::UnitZ()).dot((camera.centre_in_world() - root.translation).normalized());
}

template <class T, class Value>
void sort_best_first(std::vector<T>& items, Value value) {
  std::stable_sort(items.begin(), items.end(), [&](const T& a, const T& b) { return value(a) > value(b); });
}

// The first `count` items, in order, of each of eight sectors.
template <class T, class Sector>
void keep_per_sector(std::vector<T>& items, int count, Sector sector) {
  std::array<int, 8> taken{};
  std::erase_if(items, [&](const T& item) { return ++taken[static_cast<size_t>(sector(item))] > count; });
}

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
  sort_best_first(order, [&](size_t k) { return values[k]; });
  const Skeleton& skeleton = likelihood.body().skeleton;
  const auto pose_of = [&](size_t k) {
    return std::span<const double>(placed.row(static_cast<Eigen::Index>(k)).data(), static_cast<size_t>(placed.cols()));
  };
  keep_per_sector(order, options.num_descended_per_heading,
                  [&](size_t k) { return heading_sector(skeleton, pose_of(k)); });

  std::vector<StartingPose> starts(order.size());
  parallel_for(order.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      starts[i] = descend(likelihood, evidence, pose_of(order[i]), options.num_iterations);
    }
  });
  sort_best_first(starts, [](const StartingPose& start) { return start.log_likelihood; });
  keep_per_sector(starts, 1, [&](const StartingPose& start) { return heading_sector(skeleton, start.pose); });
  starts.resize(std::min(starts.size(), static_cast<size_t>(options.num_polished)));
  for (size_t i = 0; i < starts.size(); ++i) starts[i] = polish(likelihood, evidence, starts[i], options, i);
  const PinholeCamera& camera = likelihood.renderers().front()->camera();
  const auto with_bonus = [&](const StartingPose& start) {
    return start.log_likelihood + options.facing_bonus * faces_camera(likelihood.body(), camera, start.pose);
  };
  sort_best_first(starts, with_bonus);
  uint64_t stream = starts.size();
  for (std::vector<double>& variant : exchanged_limbs(skeleton, starts.front().pose)) {
    StartingPose start{std::move(variant), 0};
    likelihood.log_likelihood(evidence, one_state(start.pose), {&start.log_likelihood, 1});
    starts.push_back(polish(likelihood, evidence, start, options, stream++));
  }
  sort_best_first(starts, with_bonus);
  return starts;
}

}  // namespace silpose
