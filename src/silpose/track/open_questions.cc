#include "silpose/track/open_questions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "silpose/geometry/rigid3.h"
#include "silpose/track/keypoint_sides.h"

namespace silpose {
namespace {

constexpr double kIntervalOfDeviation = 1.645;  // half of a 90 % interval [definition] of a normal distribution
constexpr double kGap_s = 0.2;                  // [guess] stretches that are closer than this are joined
constexpr size_t kMostStretches = 4;            // [guess] that a line lists
constexpr double kTwistCosine = 0.5;            // [guess] an axis nearer to the bone than 60 degrees twists it

struct Stretch {
  double begin_s = 0, end_s = 0;
  int frames = 0;
  double worst = 0;
};

// Stretches of frames whose `value` is above `least`; a frame without a value is in none.
template <typename Value>
std::vector<Stretch> stretches(std::span<const StepReport> reports, double least, const Value& value) {
  std::vector<Stretch> found;
  for (const StepReport& report : reports) {
    const std::optional<double> now = value(report);
    if (!now || !(*now > least)) continue;
    const double time = report.time_s();
    if (found.empty() || time - found.back().end_s > kGap_s) found.push_back({time, time});
    found.back().end_s = time;
    found.back().worst = std::max(found.back().worst, *now);
    ++found.back().frames;
  }
  return found;
}

std::string times_of(std::span<const Stretch> some) {
  std::string text;
  for (size_t i = 0; i < std::min(some.size(), kMostStretches); ++i) {
    text += fmt::format("{}{:.1f}-{:.1f}", i == 0 ? "" : ", ", some[i].begin_s, some[i].end_s);
  }
  return text + (some.size() > kMostStretches ? " s and later" : " s");
}

int frames_of(std::span<const Stretch> some) {
  int sum = 0;
  for (const Stretch& stretch : some) sum += stretch.frames;
  return sum;
}

// [J] the joints of limbs in pairs but for the last one of each; for a rig without such limbs, all joints.
std::vector<bool> joints_between_bones(const BodyModel& body) {
  const RigProfile& profile = body.profile;
  std::vector<bool> is_between(body.skeleton.joints().size(), profile.limb_pairs.empty());
  for (const auto& [right, left] : profile.limb_pairs) {
    for (const size_t limb : {right, left}) {
      for (const int j : profile.limbs[limb].joints) is_between[static_cast<size_t>(j)] = true;
      is_between[static_cast<size_t>(profile.limbs[limb].joints.back())] = false;
    }
  }
  return is_between;
}

// The direction of a joint's bone in the joint's frame: to the next joint, or to its end point; zero where neither is.
Eigen::Vector3d bone_in_joint(const BodyModel& body, int joint_idx) {
  for (const Joint& joint : body.skeleton.joints()) {
    if (joint.parent_idx == joint_idx) return joint.offset_in_parent.stableNormalized();
  }
  for (const BodyModel::EndPoint& end : body.end_points) {
    if (end.joint_idx == joint_idx) return end.offset_in_joint.stableNormalized();
  }
  return Eigen::Vector3d::Zero();
}

}  // namespace

std::vector<std::string> doubtful_angles(std::span<const StepReport> reports, const BodyModel& body, size_t most) {
  const Skeleton& skeleton = body.skeleton;
  const std::vector<bool> is_wanted = joints_between_bones(body);
  std::vector<std::pair<double, std::string>> found;
  for (size_t j = 0; j < skeleton.joints().size(); ++j) {
    if (!is_wanted[j]) continue;
    const Eigen::Vector3d bone = bone_in_joint(body, static_cast<int>(j));
    const auto widest = [&](const StepReport& report) -> std::optional<double> {
      if (report.spread.empty()) return std::nullopt;
      double half = 0;
      for (const int d : skeleton.joints()[j].dof_indices) {
        // A twist about the bone is left out: it moves only the joints below it.
        const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
        if (dof.is_translation || std::abs(dof.axis.dot(bone)) > kTwistCosine) continue;
        half = std::max(half, kIntervalOfDeviation * to_degrees(report.spread[static_cast<size_t>(d)]));
      }
      return half;
    };
    for (const Stretch& stretch : stretches(reports, kDoubtful_deg, widest)) {
      if (stretch.end_s - stretch.begin_s < kShortest_s) continue;
      found.emplace_back(stretch.worst,
                         fmt::format("{} {:.1f}-{:.1f} s: within {:.0f} degrees", skeleton.joints()[j].name,
                                     stretch.begin_s, stretch.end_s, stretch.worst));
    }
  }
  std::ranges::stable_sort(found, [](const auto& a, const auto& b) { return a.first > b.first; });
  if (found.size() > most) found.resize(most);
  std::vector<std::string> lines;
  for (auto& [worst, line] : found) lines.push_back(std::move(line));
  return lines;
}

std::vector<std::string> ambiguities(std::span<const StepReport> reports) {
  std::vector<std::string> lines;
  const auto exchanged = stretches(reports, kExchanged, [](const StepReport& r) { return std::optional(r.exchanged); });
  if (!exchanged.empty()) {
    lines.push_back(
        fmt::format("the network took left for right in {} frames ({}): its keypoints were left out there; look "
                    "whether the sides are "
                    "right",
                    frames_of(exchanged), times_of(exchanged)));
  }
  const auto turned = stretches(reports, kOpenWeight, [](const StepReport& r) { return std::optional(r.turned); });
  if (!turned.empty()) {
    lines.push_back(
        fmt::format("front and back are ambiguous in {} frames ({}): a pose that faces the other way is about as "
                    "likely; --init with a pose, or a second camera, settles it",
                    frames_of(turned), times_of(turned)));
  }
  const auto crossed = stretches(reports, kOpenWeight, [](const StepReport& r) { return std::optional(r.crossed); });
  if (!crossed.empty()) {
    lines.push_back(
        fmt::format("left and right leg are ambiguous in {} frames ({}): a pose with the legs exchanged is about "
                    "as likely",
                    frames_of(crossed), times_of(crossed)));
  }
  return lines;
}

}  // namespace silpose
