#include "silpose/session/subject_fit.h"

#include <optional>
#include <utility>

#include "silpose/base/option_error.h"
#include "silpose/offline/track_clip.h"
#include "silpose/session/body_choice.h"
#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

// The clip's instants, tracked and fitted to; asks the context whether to go on.
class Fitting {
 public:
  Fitting(ObservationSource& source, const RunContext& context) : source_(source), context_(context) {}

  Result<BodyFit> fit(const TrackerOptions& tracker) {
    if (Result<void> read = read_clip(); !read) return read.failure();
    if (stopped_) return interrupted();
    const std::string& name = source_.video().name();
    if (clip_.empty()) return error("{}: no frame between --start and --end", name);
    const auto poses = track(tracker);
    const int64_t total = std::ssize(clip_);
    std::optional<BodyFit> fit;
    if (!stopped_) {
      fit = fit_body(tracker, clip_, poses, [&] { return proceed("fitting the body", total, total); });
    }
    if (stopped_) return interrupted();
    if (!fit) return error("{}: no body fitted: {}", name, why_not_fitted(tracker));
    return std::move(*fit);
  }

 private:
  static tl::unexpected<Error> interrupted() { return error("interrupted: no body is fitted"); }

  bool proceed(const char* what, int64_t done, int64_t total) {
    stopped_ = stopped_ || !context_.update(what, done, total);
    return !stopped_;
  }

  Result<void> read_clip() {
    while (proceed("segmenting", std::ssize(clip_), source_.num_expected())) {
      Result<std::optional<Instant>> instant = source_.next();
      if (!instant) return instant.failure();
      if (!instant->has_value()) break;
      Instant& now = **instant;
      clip_.push_back({now.frame.index, now.frame.time_ns, std::move(now.observations)});
    }
    return {};
  }

  std::vector<std::vector<double>> track(const TrackerOptions& tracker) {
    const auto progress = [&](size_t done, size_t total) {
      return proceed("tracking the body as given", static_cast<int64_t>(done), static_cast<int64_t>(total));
    };
    std::vector<std::vector<double>> poses;
    for (const StepReport& report : track_clip(options_before_fit(tracker), clip_, progress)) {
      poses.push_back(report.pose);
    }
    return poses;
  }

  ObservationSource& source_;
  const RunContext& context_;
  std::vector<ClipInstant> clip_;
  bool stopped_ = false;
};

}  // namespace

void SubjectFitOptions::check() const {
  input.check();
  if (!camera.has_file()) {
    throw_option_error("--camera is missing: fitting a body needs calibrated cameras, a single one with its floor");
  }
}

Result<SubjectFit> fit_subject(const SubjectFitOptions& options, const RunContext& context) {
  options.check();
  const Result<std::shared_ptr<const BodyModel>> body = choose_body(options.model, context);
  if (!body) return body.failure();
  const Result<OpenClip> clip = open_clip(options.input, options.camera, context);
  if (!clip) return clip.failure();
  TrackerOptions tracker = accurate_preset();
  tracker.body = *body;
  tracker.cameras = clip->cameras.cameras;
  tracker.size_deviation = size_deviation_of(options.model);
  tracker.seed = options.seed;
  tracker.landmarks = clip->source->finds_keypoints();
  Result<BodyFit> fit = Fitting(*clip->source, context).fit(tracker);
  if (!fit) return fit.failure();

  SubjectFit subject{std::move(*fit), clip->cameras.warnings};
  const std::vector<std::string> of_input = warnings_of(*clip->source, options.input);
  subject.warnings.insert(subject.warnings.end(), of_input.begin(), of_input.end());
  if (subject.fit.lengths.empty()) {
    subject.warnings.emplace_back(
        "one camera without keypoints determines only the size of a subject on the floor, not bones or girths; "
        "--segmenter learned finds keypoints, and two cameras need none");
  }
  return subject;
}

}  // namespace silpose
