#include "apps/silpose/subject_fit.h"

#include <fmt/format.h>

namespace silpose::app {
namespace {

nlohmann::ordered_json figure(double mean, double std) { return {{"mean", mean}, {"std", std}}; }

}  // namespace

std::vector<std::vector<double>> poses_as_given(const TrackerOptions& tracker, std::span<const ClipInstant> clip,
                                                Console& console, const ClipResume& resume) {
  const auto progress = [&](size_t done, size_t total) {
    return console.update("tracking the body as given", static_cast<int64_t>(done), static_cast<int64_t>(total));
  };
  std::vector<std::vector<double>> poses;
  for (const StepReport& report : track_clip(options_before_fit(tracker), clip, progress, resume)) {
    poses.push_back(report.pose);
  }
  return poses;
}

std::optional<BodyFit> fit_subject(const TrackerOptions& tracker, std::span<const ClipInstant> clip,
                                   std::span<const std::vector<double>> poses, Console& console) {
  if (Console::interrupted()) return std::nullopt;
  const auto total = static_cast<int64_t>(clip.size());
  std::optional<BodyFit> fit =
      fit_body(tracker, clip, poses, [&] { return console.update("fitting the body", total, total); });
  return Console::interrupted() ? std::nullopt : std::move(fit);
}

std::string why_not_fitted(const TrackerOptions& tracker) {
  if (tracker.cameras.size() > 1) return "there is no frame in which two cameras see the subject";
  return tracker.has_floor()
             ? "no frame has 3D keypoints, and the subject does not stand on the floor y = 0 of the camera file"
             : "no frame has 3D keypoints, and no floor is known";
}

nlohmann::ordered_json facts_of(const BodyFit& fit) {
  nlohmann::ordered_json facts;
  if (fit.size) facts["size"] = figure(fit.size->factor, fit.size->deviation);
  for (size_t s = 0; s < fit.names.size(); ++s) {
    facts["lengths_m"][fit.names[s]] = figure(fit.lengths[s], fit.deviations[s]);
  }
  for (const BodyFit::Girth& girth : fit.girths) facts["girths"][girth.name] = figure(girth.share, girth.deviation);
  return facts;
}

std::string summary_of(const BodyFit& fit) {
  std::string what;
  if (fit.size) {
    what = fmt::format("size by the floor, {:+.1f} % (deviation over frames {:.1f} %)", 100 * (fit.size->factor - 1),
                       100 * fit.size->deviation);
  }
  if (!fit.lengths.empty()) {
    what += fmt::format("{}lengths of {} bones and {} girths", what.empty() ? "" : ", ", fit.lengths.size(),
                        fit.girths.size());
  }
  return fmt::format("{}: {:.3f} m, {:.1f} kg", what, fit.body->height_m, fit.body->weight_kg);
}

}  // namespace silpose::app
