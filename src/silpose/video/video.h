// Video in and out: a file, a directory of images, a printf pattern or a camera, read as Frames; H.264 written.
// Based on: FFmpeg for files, OpenCV's videoio for live cameras.
// Threads: one thread per VideoWriter, and per Video with those that its alone() gave.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/image/frame.h"
#include "silpose/image/frame_source.h"

namespace silpose {

struct VideoOptions {
  double default_fps = 30;  // of input that carries no rate
};

// Frames of one or several cameras in step. Move-only.
//   auto video = open_video("walk.mp4").value();
//   for (const Frame& frame : video) ...
class Video {
 public:
  Video(Video&&) noexcept;
  Video& operator=(Video&&) noexcept;
  ~Video();

  [[nodiscard]] int num_cameras() const;
  [[nodiscard]] int width(int camera = 0) const;
  [[nodiscard]] int height(int camera = 0) const;
  // The nominal rate; of a clip of variable rate its mean. The times of frames are in the frames themselves.
  [[nodiscard]] double fps() const;
  [[nodiscard]] bool fps_assumed() const;  // the input carries no rate
  [[nodiscard]] bool is_live() const;      // a camera: cannot rewind
  // Number of frames according to the container (0: unknown); the true number is known at the end.
  [[nodiscard]] int64_t num_frames_hint() const;
  // Of the first frame: 0, or the number of the first of numbered images.
  [[nodiscard]] int64_t first_index() const;
  // Of a camera's image in the last frame, had the camera been opened alone: Frame::index unless numbers differ, or
  // one of them dropped an image.
  [[nodiscard]] int64_t own_index(int camera) const;
  [[nodiscard]] const std::string& name() const;
  // The focal length as the 35 mm equivalent, mm: what a video's or the first JPEG's metadata (QuickTime, EXIF) say.
  [[nodiscard]] std::optional<double> focal_mm35(int camera = 0) const;

  // The next frame, nothing at the end. Errors: an image whose size differs from the first one's; a stream that breaks
  // off before the frames its container promises is the end, and truncated() says so.
  Result<std::optional<Frame>> next();
  [[nodiscard]] bool truncated() const;
  // What the user should know about this input as far as it was read (made square, interlaced, breaks off, ...), one
  // line each.
  [[nodiscard]] std::vector<std::string> warnings() const;

  // Back to the first frame. Errors: a live camera of which a frame was read; the input vanished.
  Result<void> rewind();

  // The frames of one camera alone, from the same source: reading either moves both. REQUIRES: rewind() before the
  // first frame of it, and again before the next frame of this one.
  [[nodiscard]] Video alone(int camera);

  // Range-for over the frames left. Errors: throws std::runtime_error where next() would return an error.
  class Iterator {
   public:
    explicit Iterator(Video* video) : video_(video) { ++*this; }
    Iterator() = default;
    const Frame& operator*() const { return *frame_; }
    Iterator& operator++() {
      frame_ = video_->next().value();
      return *this;
    }
    bool operator!=(const Iterator&) const { return frame_.has_value(); }

   private:
    Video* video_ = nullptr;
    std::optional<Frame> frame_;
  };
  Iterator begin() { return Iterator(this); }
  Iterator end() { return {}; }

 private:
  friend Result<Video> join_sources(std::vector<std::unique_ptr<FrameSource>>, const VideoOptions&);
  struct Impl;
  explicit Video(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// The frames of sources in step, one per camera. Errors: those of the sources; no frame in one; rates that differ by
// more than 10 %.
Result<Video> join_sources(std::vector<std::unique_ptr<FrameSource>> sources, const VideoOptions& options = {});

// Opens a file, a directory of images, a printf pattern ("img-%06d.png") or "camera:N".
// A file's frames are as a player shows them: turned upright, of square pixels, each at the time its container says,
// counted from the first one's; where it has none, index / fps. Several cameras' frames go together by their times.
// Images whose names are one text and a number up to 99,999,999 each (000030.png, walk-7.png) come in the order of
// their numbers, which are the indices of their frames; gaps stay gaps, in time too. Other images come in the order
// of their names, counted from 0. So do those of several inputs whose numbers differ.
// Errors: missing, empty, not a video, no frame in it, a number that is there twice; several inputs whose rates differ
// by more than 10 %.
Result<Video> open_video(const std::vector<std::string>& inputs, const VideoOptions& options = {});
Result<Video> open_video(const std::string& input, const VideoOptions& options = {});

// Writes H.264 in MP4 (yuv420p; odd sizes are padded by one row or column). Move-only; a file that is not closed has no
// end and cannot be read.
class VideoWriter {
 public:
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;
  ~VideoWriter();

  // At `time_ns`, in the first image's own time, or one frame interval after the last. Errors: size other than the
  // first image's; the encoder refuses; not writable. REQUIRES: times that grow.
  Result<void> write(const ByteImage& image, std::optional<int64_t> time_ns = {});
  // Errors: not writable (disk full). A second call does nothing.
  Result<void> close();

 private:
  friend Result<VideoWriter> create_video(const std::filesystem::path&, int, int, double);
  struct Impl;
  explicit VideoWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// `fps`: nominal, where images have times of their own. Errors: not writable; no H.264 encoder.
Result<VideoWriter> create_video(const std::filesystem::path& path, int width, int height, double fps);

}  // namespace silpose
