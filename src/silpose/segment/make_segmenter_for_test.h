// A clip of the test scene on disk, and segmenters made of it.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "silpose/base/folder_for_test.h"
#include "silpose/segment/make_segmenter.h"
#include "silpose/segment/scene_for_test.h"

namespace silpose {

inline Result<std::unique_ptr<Segmenter>> make_of(const std::string& input, const SegmenterOptions& options = {},
                                                  double default_fps = 30, ProgressSink* progress = nullptr) {
  Result<Video> video = open_video(input, {.default_fps = default_fps});
  if (!video) return video.failure();
  return make_segmenter(*video, options, progress);
}

// A clip of images at 10 frames per second: frames 0-9 empty, then the subject walks through, 5 pixels per frame.
class MakeSegmenterTest : public FolderTest {
 protected:
  static constexpr int kEmpty = 10, kFrames = 50;

  MakeSegmenterTest() {
    std::filesystem::create_directories(folder_ / "clip");
    for (int i = 0; i < kFrames; ++i) {
      write_image(folder_ / "clip" / fmt::format("{:03}.png", i), image(i)).value();
    }
  }

  [[nodiscard]] static int place(int index) { return index < kEmpty ? -100 : -20 + 5 * (index - kEmpty); }
  [[nodiscard]] ByteImage image(int index) const { return scene_.image(place(index), static_cast<uint64_t>(index)); }
  [[nodiscard]] Mask truth(int index) const { return scene_.subject(place(index)); }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }

  void write_masks(const std::string& name, int count, int first = 0, int first_number = 0) const {
    std::filesystem::create_directories(folder_ / name);
    for (int i = 0; i < count; ++i) {
      write_mask(folder_ / name / fmt::format("{:03}.png", first_number + i), truth(first + i)).value();
    }
  }

  // From frame `first` on.
  void expect_finds_subject(Segmenter& segmenter, int first) const {
    for (int i = first; i < kFrames; ++i) {
      const Observation result = segmenter.segment(image(i), i).value();
      if (truth(i).count() == 0) {
        EXPECT_TRUE(result.trust.nothing_found) << i;
      } else if (truth(i).count() == 24 * 60) {
        EXPECT_GT(intersection_over_union(result.mask, truth(i)), 0.93) << i;
      }
    }
  }

  [[nodiscard]] std::string failure(const SegmenterOptions& options) const {
    const auto made = make_of(at("clip"), options);
    return made ? "" : made.error().message;
  }

  TestScene scene_;
};

}  // namespace silpose
