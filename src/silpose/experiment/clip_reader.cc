#include "silpose/experiment/clip_reader.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "silpose/segment/make_segmenter.h"
#include "silpose/segment/segmenter.h"
#include "silpose/video/video.h"

namespace silpose {
namespace {

size_t bytes_of(const Observation& observation) {
  const auto pixels = static_cast<size_t>(observation.mask.width()) * static_cast<size_t>(observation.mask.height());
  return pixels / 8 + observation.confidence.pixels().size();
}

}  // namespace

Result<const ClipReader::Segmented*> ClipReader::segment(const ClipInput& input, size_t camera,
                                                         const std::function<bool(const Segmented&)>& is_enough,
                                                         const std::function<bool()>& go_on) {
  const std::string& path = input.videos[camera];
  const std::string background = input.backgrounds.empty() ? "auto" : input.backgrounds[camera];
  const bool is_background = input.segmenter == "background";
  const std::string key = fmt::format("{}\n{}\n{}", path, input.segmenter, is_background ? background : "");
  const auto kept = std::ranges::find(kept_, key, &Segmented::key);
  if (kept != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, kept);
    if (kept_.front().is_whole || is_enough(kept_.front())) return &kept_.front();
    kept_.pop_front();  // too short
  }

  Segmented now;
  now.key = key;
  Result<Video> video = open_video(path);
  if (!video) return video.failure();
  SegmenterOptions options{.kind = input.segmenter, .networks = networks_};
  if (is_background) {
    Result<BackgroundOrigin> origin = background_origin_of(background);
    if (!origin) return origin.failure();
    options.background = std::move(*origin);
  }
  const auto segmenter = make_segmenter(*video, options);
  if (!segmenter) return segmenter.failure();
  if (Result<void> rewound = video->rewind(); !rewound) return rewound.failure();
  while (now.seen.empty() || !is_enough(now)) {
    if (!go_on()) return nullptr;
    const Result<std::optional<Frame>> frame = video->next();
    if (!frame) return frame.failure();
    if (!frame->has_value()) {
      now.is_whole = true;
      break;
    }
    Result<Observation> seen = (*segmenter)->segment((*frame)->images[0], (*frame)->index);
    if (!seen) return seen.failure();
    ++num_segmented_;
    now.indices.push_back((*frame)->index);
    now.times_ns.push_back((*frame)->time_ns);
    now.seen.push_back(std::move(*seen));
    now.bytes += bytes_of(now.seen.back());
  }
  if (now.seen.empty()) return error("{}: no frame in it", path);
  kept_.push_front(std::move(now));
  return &kept_.front();
}

Result<std::optional<std::vector<ClipInstant>>> ClipReader::read(const ClipInput& input,
                                                                 const std::function<bool()>& go_on) {
  const auto count = static_cast<size_t>(input.num_frames);
  std::vector<ClipInstant> instants;
  const auto add = [&](const Segmented& segmented, size_t frame, size_t instant) {
    instants[instant].observations.push_back(segmented.seen[frame]);
  };
  if (input.videos.size() == 1) {
    const auto segmented = segment(
        input, 0, [&](const Segmented& s) { return count > 0 && s.seen.size() >= count; }, go_on);
    if (!segmented) return segmented.failure();
    if (*segmented == nullptr) return std::optional<std::vector<ClipInstant>>();
    const Segmented& all = **segmented;
    instants.resize(count > 0 ? std::min(count, all.seen.size()) : all.seen.size());
    for (size_t t = 0; t < instants.size(); ++t) {
      instants[t].frame_idx = all.indices[t];
      instants[t].time_ns = all.times_ns[t];
      add(all, t, t);
    }
    drop_old();
    return std::optional(std::move(instants));
  }

  std::vector<Step> steps;
  Result<Video> video = open_video(input.videos);
  if (!video) return video.failure();
  while (count == 0 || steps.size() < count) {
    if (!go_on()) return std::optional<std::vector<ClipInstant>>();
    const Result<std::optional<Frame>> frame = video->next();
    if (!frame) return frame.failure();
    if (!frame->has_value()) break;
    Step& step = steps.emplace_back(Step{(*frame)->index, (*frame)->time_ns, {}});
    for (int c = 0; c < video->num_cameras(); ++c) step.own.push_back(video->own_index(c));
  }
  if (steps.empty()) return error("{}: no frame in them", video->name());
  for (const Step& step : steps) instants.push_back({step.frame_idx, step.time_ns, {}});
  for (size_t camera = 0; camera < input.videos.size(); ++camera) {
    const int64_t last = steps.back().own[camera];
    const auto segmented = segment(
        input, camera, [&](const Segmented& s) { return s.indices.back() >= last; }, go_on);
    if (!segmented) return segmented.failure();
    if (*segmented == nullptr) return std::optional<std::vector<ClipInstant>>();
    const Segmented& all = **segmented;
    for (size_t t = 0; t < steps.size(); ++t) {
      const auto at = std::ranges::lower_bound(all.indices, steps[t].own[camera]);
      if (at == all.indices.end() || *at != steps[t].own[camera]) {
        return error("{}: has no frame {} when it is read by itself", input.videos[camera], steps[t].own[camera]);
      }
      add(all, static_cast<size_t>(at - all.indices.begin()), t);
    }
  }
  drop_old();
  return std::optional(std::move(instants));
}

void ClipReader::drop_old() {
  while (!kept_.empty() && kept_bytes() > keep_bytes_) kept_.pop_back();
}

size_t ClipReader::kept_bytes() const {
  size_t sum = 0;
  for (const Segmented& segmented : kept_) sum += segmented.bytes;
  return sum;
}

}  // namespace silpose
