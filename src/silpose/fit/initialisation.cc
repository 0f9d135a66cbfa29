#include "silpose/fit/initialisation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/fit/depth_ambiguity_moves.h"
#include "silpose/fit/limb_search.h"
#include "silpose/fit/limb_variants.h"
#include "silpose/fit/place_on_mask.h"

namespace silpose {
namespace {

// [guess] All candidates are fitted at these; the best of each heading at the finer ones.
constexpr FitStage kCoarseStages[] = {{Blur::k32, 3}, {Blur::k16, 4}};
constexpr FitStage kFineStages[] = {{Blur::k16, 2}, {Blur::k8, 5}, {Blur::k4, 4}};
constexpr FitStage kVariantStages[] = {{Blur::k8, 4}, {Blur::k4, 4}};  // the better ones advance to the second
constexpr FitStage kDistantStages[] = {{Blur::k8, 6}, {Blur::k4, 8}};
constexpr uint64_t kDistantStream = std::numeric_limits<uint64_t>::max();  // of random numbers, and those below
// [guess] E of a start that leaves nothing to explain; and how far a variant must be from its origin to be worth a fit,
// metres.
constexpr double kExplained = 3, kNovelty = 0.15;
constexpr double kTwoAtOnce = 0.3;  // [guess] share of the random limbs that come in pairs
// [guess] A round of other limbs that leaves more than this of the cost is stale; as many of them in a row end a
// search. So does an E, after as many rounds, that is far more than is left elsewhere.
constexpr double kStaleCost = 0.97, kHopelessRatio = 5, kHopeless = 100;
constexpr int kStaleRounds = 2;
constexpr double kContradicted = 20;  // [guess] by keypoints, more than the best start

// Loosely about a candidate: joints by half their range, the tilt of what stands upright by 20 degrees; where the body
// is, and which way it faces, is free.
GaussianPrior prior_about(const BodyModel& body, const Eigen::VectorXd& pose) {
  GaussianPrior prior{pose, Eigen::MatrixXd::Zero(pose.size(), pose.size())};
  for (Eigen::Index d = 0; d < pose.size(); ++d) {
    const Dof& dof = body.skeleton.dofs()[static_cast<size_t>(d)];
    const bool is_tilt = dof.joint_idx == 0 && body.profile.up.has_value();
    double deviation = dof.is_translation ? 0 : is_tilt ? to_radians(20) : 0.5 * (dof.upper - dof.lower);
    if (d == body.profile.heading) deviation = 0;
    prior.information(d, d) = deviation > 0 ? 1 / (deviation * deviation) : 1e-6;
  }
  return prior;
}

// [guess] Which of so many directions a pose faces: 0 for a rig without heading.
constexpr int kNumSectors = 8;
int heading_sector(const RigProfile& profile, const Eigen::VectorXd& pose) {
  if (!profile.heading) return 0;
  return static_cast<int>(std::lround(wrap_angle(pose[*profile.heading]) / (kPi / 4)) + kNumSectors) % kNumSectors;
}

// Front and back look alike in a silhouette. Without other evidence, who is in front of a camera faces it: 1 when the
// root does, -1 when its back does; 0 for a rig without a front.
double faces_camera(const BodyModel& body, const PinholeCamera& camera, std::span<const double> pose) {
  if (!body.profile.facing) return 0;
  const Rigid3 root = body.skeleton.forward_kinematics(pose).front();
  return (root.rotation * *body.profile.facing).dot((camera.centre_in_world() - root.translation).normalized());
}

struct Candidate {
  GaussianPrior prior;
  PoseFit fit;
  [[nodiscard]] double cost() const { return fit.cost(); }
};

// What candidates are fitted to.
struct StartContext {
  const CoverageLikelihood& likelihood;
  const PosePrior& pose_prior;
  const CoverageEvidence& evidence;
  Eigen::Vector3d camera_centre;  // of the first camera that is used

  [[nodiscard]] const BodyModel& body() const { return likelihood.body(); }
};

void fit_all(const StartContext& context, std::span<const FitStage> stages, std::vector<Candidate>& candidates) {
  parallel_for(candidates.size(), 1, [&](size_t begin, size_t end) {
    CoverageLikelihood::Scratch scratch(context.likelihood);
    for (size_t i = begin; i < end; ++i) {
      Candidate& c = candidates[i];
      c.fit =
          fit_pose(context.likelihood, context.pose_prior, context.evidence, c.prior, c.fit.pose, stages, {}, scratch);
    }
  });
}

void sort_best_first(std::vector<Candidate>& candidates) { std::ranges::stable_sort(candidates, {}, &Candidate::cost); }

Candidate candidate_at(const BodyModel& body, std::span<const double> pose) {
  Candidate candidate;
  candidate.fit.pose = Eigen::Map<const Eigen::VectorXd>(pose.data(), std::ssize(pose));
  candidate.prior = prior_about(body, candidate.fit.pose);
  return candidate;
}

// The best, of which every two differ in some joint by more than `distance`.
void keep_distinct(const BodyModel& body, double distance, size_t most, std::vector<Candidate>& candidates) {
  sort_best_first(candidates);
  std::vector<std::vector<Eigen::Vector3d>> kept;
  std::erase_if(candidates, [&](const Candidate& candidate) {
    if (kept.size() >= most) return true;
    auto x = landmark_positions(body, view(candidate.fit.pose));
    if (std::ranges::any_of(kept, [&](const auto& other) { return furthest_apart(x, other) < distance; })) return true;
    kept.push_back(std::move(x));
    return false;
  });
}

// Of the best starts, with the limbs that look most promising.
std::vector<Candidate> ranked_variants(const StartContext& context, std::span<const Candidate> starts,
                                       const InitialisationOptions& options, uint64_t stream) {
  const std::vector<Limb>& limbs = context.body().profile.limbs;
  const LimbSearchOptions search{options.num_random_limbs, options.num_fitted, kNovelty, kTwoAtOnce};
  std::vector<std::vector<LimbVariant>> variants(std::min(starts.size(), static_cast<size_t>(options.num_varied)));
  parallel_for(variants.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Rng rng(options.seed, stream, i);
      variants[i] = rank_limb_variants(context.likelihood, context.evidence, limbs, view(starts[i].fit.pose),
                                       context.camera_centre, search, rng);
    }
  });
  std::vector<Candidate> chosen;
  for (const auto& of_start : variants) {
    for (const LimbVariant& variant : of_start) chosen.push_back(candidate_at(context.body(), variant.pose));
  }
  return chosen;
}

// Poses that look like the best starts and are far from them: two exchanged limbs cannot be corrected one by one.
std::vector<Candidate> distant_variants(const StartContext& context, std::span<const Candidate> starts,
                                        const InitialisationOptions& options, uint64_t index) {
  std::vector<Candidate> chosen;
  for (size_t i = 0; i < std::min(starts.size(), static_cast<size_t>(options.num_varied)); ++i) {
    Rng rng(options.seed, kDistantStream - index, i);
    for (const auto& pose :
         depth_ambiguity_moves(context.body(), view(starts[i].fit.pose), context.camera_centre, rng)) {
      chosen.push_back(candidate_at(context.body(), pose));
    }
  }
  fit_all(context, kDistantStages, chosen);
  return chosen;
}

// Starts by the direction they face, the one with the best start first. REQUIRES: sorted, best first.
std::vector<std::vector<Candidate>> by_heading(const RigProfile& profile, std::vector<Candidate> starts) {
  std::vector<std::vector<Candidate>> groups;
  std::array<std::optional<size_t>, kNumSectors> group_of;
  for (Candidate& start : starts) {
    auto& group = group_of[static_cast<size_t>(heading_sector(profile, start.fit.pose))];
    if (!group) group = groups.size(), groups.emplace_back();
    groups[*group].push_back(std::move(start));
  }
  return groups;
}

// What starts cost where outlines are as noisy as this, [C] in units of pixel_unit^3.
void set_noise(const CoverageLikelihood& likelihood, std::span<const double> noise, CoverageEvidence& evidence,
               std::vector<Candidate>& starts, CoverageLikelihood::Scratch& scratch) {
  evidence.set_noise(noise);
  for (Candidate& start : starts) {
    start.fit.energy = likelihood.energy(evidence, Blur::k4, view(start.fit.pose), scratch);
  }
}

struct LimbRounds {
  uint64_t index;  // of this search
  double least;    // E of the best found by the others
  int patience;    // stale rounds in a row
};

// Other limbs for one heading's starts, round by round, until the best explains the silhouette or progress stops. One
// round is always worth it: what explains a silhouette may do so with right and left exchanged.
void search_limbs(const StartContext& context, const InitialisationOptions& options, const LimbRounds& rounds,
                  std::vector<Candidate>& starts) {
  const auto keep = [&] {
    keep_distinct(context.body(), options.merge_distance, static_cast<size_t>(options.num_starts), starts);
  };
  keep();
  int stale = 0;
  for (int round = 0; round < options.num_rounds && stale < rounds.patience; ++round) {
    const double energy = starts.front().fit.energy;
    if (round > 0 && energy <= kExplained) return;
    if (round >= kStaleRounds && energy > std::max(kHopelessRatio * rounds.least, kHopeless)) return;
    const double before = starts.front().cost();
    const auto stream = rounds.index * static_cast<uint64_t>(options.num_rounds) + static_cast<uint64_t>(round);
    std::vector<Candidate> variants = ranked_variants(context, starts, options, stream);
    const std::span stages(kVariantStages);
    fit_all(context, stages.first(1), variants);
    sort_best_first(variants);
    variants.resize(static_cast<size_t>(std::ceil(options.share_fitted_finely * static_cast<double>(variants.size()))));
    fit_all(context, stages.subspan(1), variants);
    std::ranges::move(variants, std::back_inserter(starts));
    keep();
    stale = starts.front().cost() > kStaleCost * before ? stale + 1 : 0;
  }
}

// The placed candidates fitted coarsely, the best of each heading finely, also as a mirror in depth shows them.
std::vector<Candidate> fitted_starts(const StartContext& context, const StateBatch& placed,
                                     const InitialisationOptions& options) {
  const BodyModel& body = context.body();
  std::vector<Candidate> starts(static_cast<size_t>(placed.rows()));
  for (size_t k = 0; k < starts.size(); ++k) {
    starts[k] = candidate_at(body, {placed.row(static_cast<Eigen::Index>(k)).data(), body.skeleton.dofs().size()});
  }
  fit_all(context, kCoarseStages, starts);
  sort_best_first(starts);
  std::array<int, kNumSectors> taken{};
  const int most = options.num_per_heading * (body.profile.heading ? 1 : kNumSectors);
  std::erase_if(starts, [&](const Candidate& c) {
    return ++taken[static_cast<size_t>(heading_sector(body.profile, c.fit.pose))] > most;
  });
  fit_all(context, kFineStages, starts);
  sort_best_first(starts);

  // The whole body mirrored in depth looks almost the same.
  std::vector<Candidate> mirrored;
  for (size_t i = 0; i < std::min(starts.size(), static_cast<size_t>(options.num_varied)); ++i) {
    const std::vector<double> pose = mirrored_in_depth(body, view(starts[i].fit.pose), context.camera_centre);
    if (!pose.empty()) mirrored.push_back(candidate_at(body, pose));
  }
  fit_all(context, kFineStages, mirrored);
  std::ranges::move(mirrored, std::back_inserter(starts));
  return starts;
}

// The quality of the best fit shows how much the differences between fits mean. During the search, outlines are taken
// for no better than exact masks have them.
std::vector<double> noise_of_search(const StartContext& context, std::span<const Candidate> starts,
                                    CoverageLikelihood::Scratch& scratch) {
  std::vector<Eigen::VectorXd> poses;
  poses.reserve(starts.size());
  for (const Candidate& start : starts) poses.push_back(start.fit.pose);
  std::vector<double> noise = context.likelihood.least_noise(context.evidence, poses, scratch);
  for (double& of_camera : noise) of_camera = std::max(of_camera, CoverageLikelihood::kExactNoise);
  return noise;
}

// Tries other limbs heading by heading, until one explains the silhouette; then from the best of all, against each
// other; then from poses that look like them and are far away, while it helps. `starts`: sorted, best first.
void search(const StartContext& context, const InitialisationOptions& options, std::vector<Candidate>& starts) {
  std::vector<std::vector<Candidate>> headings = by_heading(context.body().profile, std::move(starts));
  starts.clear();
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < headings.size(); ++i) {
    const size_t h = (static_cast<size_t>(options.first_heading) + i) % headings.size();
    if (std::cmp_less(i, options.num_headings) && least > kExplained) {
      search_limbs(context, options, {h, least, kStaleRounds}, headings[h]);
    }
    least = std::min(least, headings[h].front().fit.energy);
    std::ranges::move(headings[h], std::back_inserter(starts));
  }
  uint64_t index = headings.size();
  search_limbs(context, options, {index++, least, options.patience}, starts);
  for (int round = 0; round < options.num_distant_rounds && starts.front().fit.energy > kExplained; ++round) {
    const double before = starts.front().cost();
    std::vector<Candidate> distant = distant_variants(context, starts, options, index);
    if (distant.empty()) break;
    search_limbs(context, options, {index++, starts.front().fit.energy, kStaleRounds}, distant);
    std::ranges::move(distant, std::back_inserter(starts));
    search_limbs(context, options, {index++, starts.front().fit.energy, options.patience}, starts);
    if (starts.front().cost() > kStaleCost * before) break;
  }
}

}  // namespace

std::vector<StartingPose> initialise(const CoverageLikelihood& likelihood, const PosePrior& pose_prior,
                                     std::span<const Observation> observations, const StateBatch& candidates,
                                     const InitialisationOptions& options) {
  check(candidates.rows() > 0, "initialise: no candidates");
  const BodyModel& body = likelihood.body();
  CoverageEvidence evidence = likelihood.evidence_of(observations, Blur::k32, Blur::k2, options.evidence);
  const std::optional<size_t> seen = evidence.first_seen();
  check(seen.has_value(), "initialise: no camera found anything");
  const PinholeCamera& camera = likelihood.cameras()[*seen];
  const StartContext context{likelihood, pose_prior, evidence, camera.centre_in_world()};
  const StateBatch placed = place_on_mask(body, camera, observations[*seen], candidates);
  std::vector<Candidate> starts = fitted_starts(context, placed, options);
  CoverageLikelihood::Scratch scratch(likelihood);
  set_noise(likelihood, noise_of_search(context, starts, scratch), evidence, starts, scratch);
  sort_best_first(starts);
  search(context, options, starts);

  const std::vector<double> noise = likelihood.estimate_noise(evidence, view(starts.front().fit.pose), scratch);
  set_noise(likelihood, noise, evidence, starts, scratch);
  const auto has_keypoints = [](const CoverageEvidence::View& view) { return view.keypoints != nullptr; };
  const double facing_bonus = std::ranges::any_of(evidence.views, has_keypoints) ? 0 : options.facing_bonus;
  const auto log_likelihood = [&](const Candidate& c) {
    return -0.5 * c.cost() + facing_bonus * faces_camera(body, camera, view(c.fit.pose));
  };
  std::ranges::stable_sort(starts, std::greater<>{}, log_likelihood);
  // The filter may use silhouettes alone: poses that fit these as well but contradict the keypoints must be excluded.
  const auto keypoint_cost = [&](const Candidate& c) {
    return evidence.keypoint_cost(body.skeleton, view(c.fit.pose));
  };
  const double worst = keypoint_cost(starts.front()) + kContradicted;
  std::erase_if(starts, [&](const Candidate& c) { return keypoint_cost(c) > worst; });
  std::vector<StartingPose> best;
  best.reserve(starts.size());
  for (const Candidate& start : starts) {
    best.push_back({{start.fit.pose.begin(), start.fit.pose.end()}, log_likelihood(start)});
  }
  return best;
}

}  // namespace silpose
