#include "silpose/synth/sequence_files.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <system_error>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/image/image_file.h"
#include "silpose/video/video.h"

namespace silpose {
namespace {

constexpr int kFramesAtOnce = 8;  // drawn in parallel, then written in order

// What belongs to one camera while its files are written.
struct Outputs {
  std::filesystem::path masks;
  const DegradedMasks* degraded = nullptr;  // nothing: the true masks
  std::optional<ColourScene> scene;
  std::optional<VideoWriter> video;
};

Result<void> make_directory(const std::filesystem::path& path) {
  std::error_code failure;
  std::filesystem::create_directories(path, failure);
  if (failure) return error("{}: cannot be made: {}", path.string(), failure.message());
  return {};
}

Result<std::vector<Outputs>> open_outputs(const std::filesystem::path& directory, const SyntheticSequence& sequence,
                                          const std::optional<ColourOptions>& colour) {
  std::vector<Outputs> outputs;
  for (size_t c = 0; c < sequence.cameras.size(); ++c) {
    const PinholeCamera& camera = sequence.cameras[c];
    const std::string suffix = sequence.cameras.size() == 1 ? "" : "_" + camera.name;
    Outputs output;
    output.masks = directory / ("masks" + suffix);
    if (const Result<void> made = make_directory(output.masks); !made) return made.failure();
    if (colour) {
      output.scene.emplace(sequence, static_cast<int>(c), *colour);
      Result<VideoWriter> video =
          create_video(directory / ("video" + suffix + ".mp4"), camera.width, camera.height, sequence.fps);
      if (!video) return video.failure();
      output.video.emplace(std::move(*video));
    }
    outputs.push_back(std::move(output));
  }
  return outputs;
}

// Frames [begin, end) of one camera.
Result<void> write_frames(const SyntheticSequence& sequence, int camera_idx, Outputs& output, int begin, int end) {
  const auto count = static_cast<size_t>(end - begin);
  std::vector<ByteImage> images(count);
  std::vector<std::optional<Error>> failures(count);
  parallel_for(count, 1, [&](size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      const int frame = begin + static_cast<int>(i);
      const Mask mask =
          output.degraded != nullptr ? output.degraded->draw(frame) : true_mask(sequence, camera_idx, frame);
      const Result<void> written = write_mask(output.masks / fmt::format("{:06}.png", frame), mask);
      if (!written) failures[i] = written.error();
      if (output.scene) images[i] = output.scene->draw(frame);
    }
  });
  for (const std::optional<Error>& failure : failures) {
    if (failure) return *failure;
  }
  for (const ByteImage& image : images) {
    if (!output.video) break;
    if (const Result<void> written = output.video->write(image); !written) return written.failure();
  }
  return {};
}

}  // namespace

PoseTable true_poses(const SyntheticSequence& sequence, int num_frames) {
  PoseTable table;
  for (int frame = sequence.lead_in; frame < std::min(num_frames, sequence.num_frames()); ++frame) {
    const std::span<const double> pose = pose_of_frame(sequence, frame);
    PoseTable::Row row;
    row.frame = frame;
    row.time_s = frame / sequence.fps;
    row.values.assign(pose.begin(), pose.end());
    table.rows.push_back(std::move(row));
  }
  return table;
}

JointTable true_joints(const SyntheticSequence& sequence, int num_frames) {
  JointTable table;
  const std::vector<std::string> names = landmark_names(*sequence.body);
  const PinholeCamera& camera = sequence.cameras.front();
  for (int frame = sequence.lead_in; frame < std::min(num_frames, sequence.num_frames()); ++frame) {
    const std::vector<Eigen::Vector3d> positions = landmark_positions(*sequence.body, pose_of_frame(sequence, frame));
    for (size_t j = 0; j < names.size(); ++j) {
      JointTable::Row row;
      row.frame = frame;
      row.time_s = frame / sequence.fps;
      row.joint = names[j];
      row.x_in_world = positions[j];
      row.pixel =
          camera.project(positions[j]).value_or(Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

Result<int> write_sequence(const std::filesystem::path& directory, const SyntheticSequence& sequence,
                           const std::optional<ColourOptions>& colour, ProgressSink* progress,
                           std::span<const DegradedMasks> masks) {
  check(masks.empty() || masks.size() == sequence.cameras.size(), "write_sequence: masks of {} cameras of {}",
        masks.size(), sequence.cameras.size());
  if (const Result<void> made = make_directory(directory); !made) return made.failure();
  Result<std::vector<Outputs>> outputs = open_outputs(directory, sequence, colour);
  if (!outputs) return outputs.failure();
  for (size_t c = 0; c < masks.size(); ++c) (*outputs)[c].degraded = &masks[c];
  if (const auto written = write_cameras(directory / "camera.toml", sequence.cameras); !written) {
    return written.failure();
  }

  const int total = sequence.num_frames();
  int done = 0;
  bool wanted = true;
  while (done < total && wanted) {
    const int end = std::min(done + kFramesAtOnce, total);
    for (size_t c = 0; c < outputs->size(); ++c) {
      const auto written = write_frames(sequence, static_cast<int>(c), (*outputs)[c], done, end);
      if (!written) return written.failure();
    }
    done = end;
    wanted = progress == nullptr || progress->update("frames", done, total);
  }
  for (Outputs& output : *outputs) {
    if (!output.video) continue;
    if (const Result<void> closed = output.video->close(); !closed) return closed.failure();
  }

  const Skeleton& skeleton = sequence.body->skeleton;
  const PoseTable poses = true_poses(sequence, done);
  if (const auto written = write_poses(directory / "poses.csv", skeleton, poses); !written) return written.failure();
  PoseTable normalised = poses;
  for (PoseTable::Row& row : normalised.rows) row.values = skeleton.normalise(row.values);
  const auto written_normalised =
      write_poses(directory / "poses_normalised.csv", skeleton, normalised, PoseUnits::kNormalised);
  if (!written_normalised) return written_normalised.failure();
  if (const auto written = write_joints(directory / "joints.csv", true_joints(sequence, done)); !written) {
    return written.failure();
  }
  return done;
}

}  // namespace silpose
