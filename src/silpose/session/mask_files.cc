#include "silpose/session/mask_files.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "silpose/base/state_bytes.h"
#include "silpose/image/image_file.h"

namespace silpose {

MaskFiles::MaskFiles(std::filesystem::path folder, const std::vector<PinholeCamera>& cameras)
    : folder_(std::move(folder)), strips_(cameras.size()) {
  for (const PinholeCamera& camera : cameras) cameras_.push_back(camera.name);
}

std::filesystem::path MaskFiles::file_of(std::string_view folder, size_t camera, int64_t frame_idx) const {
  std::string name(folder);
  if (cameras_.size() > 1) name += "_" + cameras_[camera];
  return folder_ / name / fmt::format("{:06}.png", frame_idx);
}

Result<void> MaskFiles::add_observed(const Frame& frame, std::span<const Observation> observations) {
  check(observations.size() == cameras_.size(), "MaskFiles: {} observations of {} cameras", observations.size(),
        cameras_.size());
  for (size_t c = 0; c < cameras_.size(); ++c) {
    const auto file = file_of(kMaskFolder, c, frame.index);
    std::error_code failed;  // writing would report it
    std::filesystem::create_directories(file.parent_path(), failed);
    if (Result<void> written = write_mask(file, observations[c].mask); !written) return written;
    strips_[c].add(frame.index, static_cast<double>(frame.time_ns) * 1e-9, frame.images[c], observations[c].mask);
    if (!keeps_confidence_ || observations[c].confidence.empty()) continue;
    const auto of_confidence = file_of(kConfidenceFolder, c, frame.index);
    std::filesystem::create_directories(of_confidence.parent_path(), failed);
    if (Result<void> kept = write_image(of_confidence, observations[c].confidence); !kept) return kept;
  }
  return {};
}

std::string MaskFiles::state() const { return to_bytes(strips_); }

void MaskFiles::restore(std::string_view state) {
  std::vector<MaskStrip> strips;
  check(from_bytes(state, strips) && strips.size() == cameras_.size(), "MaskFiles: not a state of it");
  strips_ = std::move(strips);
}

Result<std::vector<Observation>> MaskFiles::read(const Frame& frame, std::span<const MaskSidecar> sidecars) const {
  std::vector<Observation> observations(cameras_.size());
  for (size_t c = 0; c < cameras_.size(); ++c) {
    Observation& seen = observations[c];
    const auto file = file_of(kMaskFolder, c, frame.index), of_confidence = file_of(kConfidenceFolder, c, frame.index);
    Result<Mask> mask = read_mask(file);
    if (!mask) return mask.failure();
    std::error_code ignored;
    if (std::filesystem::exists(of_confidence, ignored)) {
      Result<ByteImage> confidence = read_grey_image(of_confidence);
      if (!confidence) return confidence.failure();
      seen.confidence = std::move(*confidence);
    }
    const int width = frame.images[c].width(), height = frame.images[c].height();
    const auto fits = [&](const auto& image) { return image.width() == width && image.height() == height; };
    if (!fits(*mask) || !(seen.confidence.empty() || fits(seen.confidence))) {
      return error("{}: {}x{}, the images {}x{}", file.string(), mask->width(), mask->height(), width, height);
    }
    seen.mask = std::move(*mask);
    seen.trust = sidecars[c].trust;
    seen.keypoints_2d = sidecars[c].keypoints_2d;
    seen.keypoints_3d = sidecars[c].keypoints_3d;
  }
  return observations;
}

}  // namespace silpose
