// Clips as phones and camcorders make them, for the end-to-end tests.
//   clip_tool KIND IN OUT: the video IN once more as KIND; as shown it is the same, but for
//   clip_tool boxed IN OUT: a box in the left quarter, larger than the person in the middle, from frame 20 on.
//   clip_tool times FILE: "WIDTH HEIGHT FRAMES", then each frame's number and seconds.
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "silpose/video/clip_for_test.h"
#include "silpose/video/video.h"

namespace silpose {
namespace {

// A quarter turn counter-clockwise, as a phone held upright stores it.
ByteImage laid_down(const ByteImage& shown) {
  ByteImage stored(shown.height(), shown.width(), 3);
  for (int y = 0; y < stored.height(); ++y) {
    for (int x = 0; x < stored.width(); ++x) {
      for (int c = 0; c < 3; ++c) stored.at(x, y, c) = shown.at(shown.width() - 1 - y, x, c);
    }
  }
  return stored;
}

// Half as wide.
ByteImage squeezed(const ByteImage& shown) {
  ByteImage stored(shown.width() / 2, shown.height(), 3);
  for (int y = 0; y < stored.height(); ++y) {
    for (int x = 0; x < stored.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        stored.at(x, y, c) = static_cast<uint8_t>((shown.at(2 * x, y, c) + shown.at(2 * x + 1, y, c)) / 2);
      }
    }
  }
  return stored;
}

void cover(ByteImage& image, int64_t index) {
  if (index < 20) return;
  const int top = image.height() / 5 + static_cast<int>(index % 5);  // it moves
  for (int y = top; y < top + 3 * image.height() / 5; ++y) {
    for (int x = 5; x < 5 + image.width() / 4; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<uint8_t>(60 + 40 * c);
    }
  }
}

void make(const std::string& kind, const std::string& in, const std::string& out) {
  ClipForTest clip;
  Video video = open_video(in).value();
  clip.rate = static_cast<int>(std::lround(video.fps()));
  std::vector<ByteImage> images;
  for (Frame frame : video) {
    const bool dropped = kind == "uneven" && frame.index % 5 == 3;
    if (dropped) continue;
    if (kind == "uneven") clip.times_ms.push_back(1000 + frame.time_ns / 1'000'000);
    ByteImage& shown = frame.images[0];
    if (kind == "boxed") cover(shown, frame.index);
    images.push_back(kind == "turned" ? laid_down(shown) : kind == "squeezed" ? squeezed(shown) : std::move(shown));
  }
  if (kind == "turned") clip.display_matrix = {{0, 1 << 16, 0, -(1 << 16), 0, 0, 0, 0, 1 << 30}};
  if (kind == "squeezed") clip.pixel_aspect = {2, 1};
  if (kind == "deep") clip.codec = "libx265", clip.pixel_format = "yuv420p10le";
  if (kind == "interlaced") clip.is_interlaced = true;
  write_clip_for_test(out, images, clip);
}

void print_times(const std::string& file) {
  Video video = open_video(file).value();
  std::string lines;
  int64_t count = 0;
  for (const Frame& frame : video) {
    lines += fmt::format("{} {:.6f}\n", frame.index, static_cast<double>(frame.time_ns) * 1e-9);
    ++count;
  }
  fmt::print("{} {} {}\n{}", video.width(), video.height(), count, lines);
}

}  // namespace
}  // namespace silpose

int main(int argc, char** argv) {
  const std::string kind = argc > 1 ? argv[1] : "";
  if (kind == "times" && argc == 3) {
    silpose::print_times(argv[2]);
  } else if (argc == 4) {
    silpose::make(kind, argv[2], argv[3]);
  } else {
    return 2;
  }
  return 0;
}
