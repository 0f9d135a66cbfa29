#include "silpose/track/initialisation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/normalised_silhouette.h"
#include "silpose/track/limbs.h"

namespace silpose {
namespace {

constexpr double kPlacingResolution = 96;  // raster pixels along the longer side of the silhouette
// All candidates are fitted at these; the best of each heading at the finer ones.
constexpr FitStage kCoarseStages[] = {{Blur::k32, 3}, {Blur::k16, 4}};
constexpr FitStage kFineStages[] = {{Blur::k16, 2}, {Blur::k8, 5}, {Blur::k4, 4}};

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

// Loosely about a candidate: joints by half their range, the trunk's tilt by 20 degrees; where the body is, and which
// way it faces, is free.
PosePrior prior_about(const Skeleton& skeleton, const Eigen::VectorXd& pose) {
  PosePrior prior{pose, Eigen::MatrixXd::Zero(pose.size(), pose.size())};
  for (Eigen::Index d = 0; d < pose.size(); ++d) {
    const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
    const bool vertical = dof.joint_idx == 0 && std::abs(dof.axis.y()) > 0.5;
    double deviation = dof.is_translation ? 0 : dof.joint_idx == 0 ? to_radians(20) : 0.5 * (dof.upper - dof.lower);
    if (dof.joint_idx == 0 && !dof.is_translation && vertical) deviation = 0;
    prior.information(d, d) = deviation > 0 ? 1 / (deviation * deviation) : 1e-6;
  }
  return prior;
}

// Which of eight directions a pose faces, for a skeleton whose root turns about the vertical; else 0.
int heading_sector(const Skeleton& skeleton, const Eigen::VectorXd& pose) {
  for (int d = 0; d < skeleton.num_dofs(); ++d) {
    const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
    if (dof.joint_idx == 0 && dof.is_periodic && dof.axis.y() > 0.5) {
      return static_cast<int>(std::lround(wrap_angle(pose[d]) / (kPi / 4)) + 8) % 8;
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

// How far the joint or end point that is furthest off is off.
double landmark_distance(const BodyModel& body, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const auto n = static_cast<size_t>(a.size());
  const auto x = landmark_positions(body, {a.data(), n}), y = landmark_positions(body, {b.data(), n});
  double furthest = 0;
  for (size_t i = 0; i < x.size(); ++i) furthest = std::max(furthest, (x[i] - y[i]).norm());
  return furthest;
}

struct Candidate {
  PosePrior prior;
  PoseFit fit;
};

void fit_all(const CoverageLikelihood& likelihood, const CoverageEvidence& evidence, std::span<const FitStage> stages,
             std::vector<Candidate>& candidates) {
  parallel_for(candidates.size(), 1, [&](size_t begin, size_t end) {
    CoverageLikelihood::Scratch scratch(likelihood);
    for (size_t i = begin; i < end; ++i) {
      Candidate& c = candidates[i];
      c.fit = fit_pose(likelihood, evidence, c.prior, c.fit.pose, stages, {}, scratch);
    }
  });
}

void sort_best_first(std::vector<Candidate>& candidates) {
  std::ranges::stable_sort(candidates, {}, [](const Candidate& c) { return c.fit.cost(); });
}

}  // namespace

StateBatch place_on_mask(const BodyModel& body, const PinholeCamera& camera, const Observation& observation,
                         const StateBatch& candidates) {
  check(!observation.box.empty(), "place_on_mask: nothing was found");
  const double longer_side = std::max(observation.box.width, observation.box.height);
  const Window window = window_of_image(camera.width, camera.height, std::min(1.0, kPlacingResolution / longer_side));
  const Blob observed = measure(resample_mask(observation.mask, window));
  if (observed.area < 1) return candidates;
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

std::vector<StartingPose> initialise(const CoverageLikelihood& likelihood, std::span<const Observation> observations,
                                     const StateBatch& candidates, const InitialisationOptions& options) {
  check(candidates.rows() > 0, "initialise: no candidates");
  const BodyModel& body = likelihood.body();
  const Skeleton& skeleton = body.skeleton;
  const CoverageEvidence evidence = likelihood.prepare(observations);
  size_t seen = 0;
  while (seen < observations.size() && evidence.views[seen].trust <= 0) ++seen;
  check(seen < observations.size(), "initialise: no camera has a say");
  const PinholeCamera& camera = likelihood.cameras()[seen];

  const StateBatch placed = place_on_mask(body, camera, observations[seen], candidates);
  std::vector<Candidate> starts(static_cast<size_t>(placed.rows()));
  for (size_t k = 0; k < starts.size(); ++k) {
    starts[k].fit.pose = placed.row(static_cast<Eigen::Index>(k)).head(skeleton.num_dofs());
    starts[k].prior = prior_about(skeleton, starts[k].fit.pose);
  }
  fit_all(likelihood, evidence, kCoarseStages, starts);
  sort_best_first(starts);
  std::array<int, 8> taken{};
  std::erase_if(starts, [&](const Candidate& c) {
    return ++taken[static_cast<size_t>(heading_sector(skeleton, c.fit.pose))] > options.num_per_heading;
  });
  fit_all(likelihood, evidence, kFineStages, starts);
  sort_best_first(starts);

  // What looks almost the same: limbs exchanged or reflected in depth, the whole body mirrored in depth.
  std::vector<Candidate> variants;
  const std::vector<Limb> limbs = limbs_of(skeleton);
  const auto add = [&](std::span<const double> pose) {
    if (pose.empty()) return;
    Candidate variant;
    variant.fit.pose = Eigen::Map<const Eigen::VectorXd>(pose.data(), std::ssize(pose));
    variant.prior = prior_about(skeleton, variant.fit.pose);
    variants.push_back(std::move(variant));
  };
  for (size_t i = 0; i < std::min(starts.size(), static_cast<size_t>(options.num_varied)); ++i) {
    const std::span<const double> pose(starts[i].fit.pose.data(), static_cast<size_t>(starts[i].fit.pose.size()));
    const std::vector<double> mirrored = mirrored_in_depth(skeleton, pose, camera.centre_in_world());
    add(mirrored);
    for (const auto& variant : exchanged_limbs(skeleton, pose)) add(variant);
    for (const Limb& limb : limbs) {
      for (const auto& variant : reflected_limb(body, limb, pose, camera.centre_in_world())) add(variant);
    }
  }
  fit_all(likelihood, evidence, kFineStages, variants);
  for (Candidate& variant : variants) starts.push_back(std::move(variant));

  const auto log_likelihood = [&](const Candidate& c) {
    return -0.5 * c.fit.cost() + options.facing_bonus * faces_camera(body, camera, {c.fit.pose.data(), static_cast<size_t>(c.fit.pose.size())});
  };
  std::ranges::stable_sort(starts, std::greater<>{}, log_likelihood);
  std::vector<StartingPose> best;
  std::vector<const Candidate*> kept;
  for (const Candidate& start : starts) {
    if (std::ssize(best) == options.num_starts) break;
    if (std::ranges::any_of(kept, [&](const Candidate* other) {
          return landmark_distance(body, start.fit.pose, other->fit.pose) < options.merge_distance;
        })) {
      continue;
    }
    kept.push_back(&start);
    best.push_back({{start.fit.pose.begin(), start.fit.pose.end()}, log_likelihood(start)});
  }
  return best;
}

}  // namespace silpose
