// Clips as phones, camcorders and editors make them.
#include "silpose/video/video_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "silpose/base/folder_for_test.h"
#include "silpose/image/image_file.h"
#include "silpose/video/clip_for_test.h"
#include "silpose/video/video.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

// Four corners that identify rotations: red top left, green top right, blue bottom left, dark bottom right.
ByteImage corners(int width, int height) {
  ByteImage image(width, height, 3, 30);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool right = 2 * x >= width, low = 2 * y >= height;
      if (!right && !low) image.at(x, y, 2) = 200;
      if (right && !low) image.at(x, y, 1) = 200;
      if (!right && low) image.at(x, y, 0) = 200;
    }
  }
  return image;
}

// The colours around the image, clockwise from the top left: "rgdb" as corners() draws them.
std::string clockwise(const ByteImage& image) {
  std::string found;
  const int w = image.width(), h = image.height();
  const int at[4][2] = {{w / 4, h / 4}, {3 * w / 4, h / 4}, {3 * w / 4, 3 * h / 4}, {w / 4, 3 * h / 4}};
  for (const auto& [x, y] : at) {
    const int b = image.at(x, y, 0), g = image.at(x, y, 1), r = image.at(x, y, 2);
    found += r > 120 ? 'r' : g > 120 ? 'g' : b > 120 ? 'b' : 'd';
  }
  return found;
}

class VideoFileTest : public FolderTest {
 protected:
  std::string write(const std::string& name, const ClipForTest& clip, int frames = 3, int width = 64,
                    int height = 48) const {
    const std::vector<ByteImage> images(static_cast<size_t>(frames), corners(width, height));
    write_clip_for_test(folder_ / name, images, clip);
    return (folder_ / name).string();
  }

  static std::vector<int64_t> times_ms(Video& video) {
    std::vector<int64_t> times;
    for (const Frame& frame : video) times.push_back(std::llround(static_cast<double>(frame.time_ns) * 1e-6));
    return times;
  }
};

constexpr int32_t kOne = 1 << 16, kLast = 1 << 30;

TEST_F(VideoFileTest, TurnedImagesComeUpright) {
  struct Case {
    std::array<int32_t, 4> abcd;  // x' = a x + c y, y' = b x + d y
    std::string shown;
    bool is_upright_size;
  };
  const Case cases[] = {{{kOne, 0, 0, kOne}, "rgdb", false},   {{0, kOne, -kOne, 0}, "brgd", true},
                        {{-kOne, 0, 0, -kOne}, "dbrg", false}, {{0, -kOne, kOne, 0}, "gdbr", true},
                        {{-kOne, 0, 0, kOne}, "grbd", false},  {{0, kOne, kOne, 0}, "rbdg", true}};
  for (const auto& [abcd, shown, is_upright_size] : cases) {
    const auto [a, b, c, d] = abcd;
    Video video = open_video(write("turned.mp4", {.display_matrix = {{a, b, 0, c, d, 0, 0, 0, kLast}}})).value();
    EXPECT_EQ(video.width(), is_upright_size ? 48 : 64) << shown;
    EXPECT_EQ(video.height(), is_upright_size ? 64 : 48) << shown;
    EXPECT_EQ(clockwise(video.next().value()->images[0]), shown);
    ASSERT_TRUE(video.rewind().ok());
    EXPECT_EQ(clockwise(video.next().value()->images[0]), shown) << "again";
    EXPECT_THAT(video.warnings(), IsEmpty());
  }
}

TEST_F(VideoFileTest, OtherTurnsAreReported) {
  const int32_t half = kOne / 2;
  Video video =
      open_video(write("aslant.mp4", {.display_matrix = {{half, half, 0, -half, half, 0, 0, 0, kLast}}})).value();
  EXPECT_EQ(clockwise(video.next().value()->images[0]), "rgdb");
  EXPECT_THAT(video.warnings(), ElementsAre(HasSubstr("aslant.mp4: turned by 45 degrees")));
}

TEST_F(VideoFileTest, TimesAreTheContainersFromTheFirstFrame) {
  const std::vector<int64_t> times = {700, 733, 767, 900, 917, 933, 1400};
  for (const char* name : {"uneven.mp4", "uneven.mkv", "uneven.mov"}) {
    Video video = open_video(write(name, {.times_ms = times}, 7)).value();
    EXPECT_THAT(times_ms(video), ElementsAre(0, 33, 67, 200, 217, 233, 700)) << name;
    EXPECT_THAT(video.warnings(), IsEmpty()) << name;
    EXPECT_FALSE(video.truncated()) << name;
    EXPECT_LE(video.fps(), 30) << name << ": not the 1000 per second that the time stamps would allow";
    EXPECT_EQ(video.num_frames_hint(), 7) << name;
  }
}

TEST_F(VideoFileTest, ConstantRateIsExactWhateverTheContainerRoundsTo) {
  Video video = open_video(write("even.mkv", {.rate = 30}, 40)).value();  // whole milliseconds
  EXPECT_DOUBLE_EQ(video.fps(), 30);
  int64_t i = 0;
  for (const Frame& frame : video) EXPECT_EQ(frame.time_ns, std::llround(static_cast<double>(i++) * 1e9 / 30));
  EXPECT_EQ(i, 40);
}

TEST_F(VideoFileTest, OverlayTimesComeBackAsTheyWere) {
  const std::vector<int64_t> times = {5'000'000'000, 5'033'366'700, 5'066'733'400, 5'200'000'000, 5'700'000'000};
  VideoWriter writer = create_video(folder_ / "out.mp4", 63, 47, 29.97).value();
  for (const int64_t time : times) writer.write(corners(63, 47), time).value();
  EXPECT_THROW((void)writer.write(corners(63, 47), times.back()), std::invalid_argument);
  writer.close().value();
  Video video = open_video((folder_ / "out.mp4").string()).value();
  size_t i = 0;
  for (const Frame& frame : video) EXPECT_LT(std::abs(frame.time_ns - (times[i++] - times[0])), 20'000);
  EXPECT_EQ(i, times.size());
}

TEST_F(VideoFileTest, WithoutTimesTheRateCounts) {
  Video video = open_video(write("raw.h264", {.rate = 50}, 5), {.default_fps = 10}).value();
  const double rate = video.fps();  // what the encoder said of itself, or what was asked for
  EXPECT_TRUE(rate == 50 || (rate == 10 && video.fps_assumed())) << rate;
  EXPECT_THAT(video.warnings(), testing::SizeIs(video.fps_assumed() ? 0 : 1)) << "carries no times";
  int64_t i = 0;
  for (const Frame& frame : video) EXPECT_EQ(frame.time_ns, std::llround(static_cast<double>(i++) * 1e9 / rate));
  EXPECT_EQ(i, 5);
}

TEST_F(VideoFileTest, CamerasGoTogetherByTheirTimes) {
  // The second camera dropped its third image, the first its fifth.
  const std::string a = write("a.mkv", {.times_ms = {0, 33, 67, 100, 167, 200}}, 6);
  const std::string b = write("b.mkv", {.times_ms = {0, 33, 100, 133, 167, 200}}, 6);
  Video video = open_video(std::vector<std::string>{a, b}).value();
  std::vector<int64_t> times, of_first, of_second;
  for (const Frame& frame : video) {
    times.push_back(std::llround(static_cast<double>(frame.time_ns) * 1e-6));
    of_first.push_back(video.own_index(0));
    of_second.push_back(video.own_index(1));
    EXPECT_EQ(frame.index, of_first.back());
  }
  EXPECT_THAT(times, ElementsAre(0, 33, 100, 167, 200));
  EXPECT_THAT(of_first, ElementsAre(0, 1, 3, 4, 5));
  EXPECT_THAT(of_second, ElementsAre(0, 1, 2, 4, 5));
}

TEST_F(VideoFileTest, PixelsAreMadeSquare) {
  Video wide = open_video(write("wide.mp4", {.pixel_aspect = {4, 3}})).value();
  EXPECT_EQ(wide.width(), 85);
  EXPECT_EQ(wide.height(), 48);
  EXPECT_EQ(clockwise(wide.next().value()->images[0]), "rgdb");
  EXPECT_THAT(wide.warnings(), ElementsAre(HasSubstr("wide.mp4: pixels 1.333 times as wide as high, made square")));
  Video narrow = open_video(write("narrow.mkv", {.pixel_aspect = {8, 9}})).value();
  EXPECT_EQ(narrow.width(), 64);
  EXPECT_EQ(narrow.height(), 54);
  Video nearly = open_video(write("nearly.mp4", {.pixel_aspect = {852, 853}})).value();
  EXPECT_EQ(nearly.width(), 64);
  EXPECT_THAT(nearly.warnings(), IsEmpty());
  // Turned, too: what is wide as stored is high as shown.
  Video both = open_video(write("both.mp4",
                                {.pixel_aspect = {4, 3}, .display_matrix = {{0, kOne, 0, -kOne, 0, 0, 0, 0, kLast}}}))
                   .value();
  EXPECT_EQ(both.width(), 48);
  EXPECT_EQ(both.height(), 85);
}

TEST_F(VideoFileTest, DeepGreyAndTransparentPixelsComeAsEightBitColour) {
  const std::pair<std::string, ClipForTest> clips[] = {
      {"ten.mp4", {.pixel_format = "yuv420p10le", .colour_space = AVCOL_SPC_BT2020_NCL}},
      {"hd.mp4", {.colour_space = AVCOL_SPC_BT709}},
      {"alpha.mov", {.codec = "png", .pixel_format = "rgba"}},
      {"deep.mkv", {.codec = "ffv1", .pixel_format = "gbrp16le"}},
      {"moving.gif", {.codec = "gif", .pixel_format = "bgr8", .rate = 10}}};
  for (const auto& [name, clip] : clips) {
    Video video = open_video(write(name, clip)).value();
    const ByteImage image = video.next().value()->images[0];
    EXPECT_EQ(clockwise(image), "rgdb") << name;
    if (clip.codec == "gif") continue;  // few colours
    EXPECT_NEAR(image.at(16, 12, 2), 200, 6) << name << ": the colour matrix is the right one";
    EXPECT_NEAR(image.at(16, 12, 0), 30, 6) << name;
  }
  Video grey = open_video(write("grey.mkv", {.codec = "ffv1", .pixel_format = "gray"})).value();
  const ByteImage image = grey.next().value()->images[0];
  EXPECT_EQ(image.channels(), 3);
  EXPECT_EQ(image.at(16, 12, 0), image.at(16, 12, 2));
}

TEST_F(VideoFileTest, InterlacedImagesLoseTheirComb) {
  // A bright column that moved between the two fields.
  ByteImage comb(64, 48, 3, 20);
  for (int y = 0; y < 48; ++y) {
    for (int x = y % 2 == 0 ? 16 : 32; x < (y % 2 == 0 ? 24 : 40); ++x) {
      for (int c = 0; c < 3; ++c) comb.at(x, y, c) = 220;
    }
  }
  write_clip_for_test(folder_ / "fields.mp4", std::vector<ByteImage>(3, comb), {.is_interlaced = true});
  Video video = open_video((folder_ / "fields.mp4").string()).value();
  const ByteImage image = video.next().value()->images[0];
  for (int y = 4; y < 44; ++y) {
    EXPECT_GT(image.at(20, y, 1), 180) << y;
    EXPECT_LT(image.at(36, y, 1), 60) << y;
  }
  EXPECT_THAT(video.warnings(), ElementsAre(HasSubstr("fields.mp4: interlaced")));
}

TEST_F(VideoFileTest, SoundAloneIsNoVideo) {
  const std::string path = write("song.mkv", {.has_sound = true, .has_images = false});
  EXPECT_THAT(open_video(path).error().message, EndsWith("song.mkv: sound without a video"));
  Video both = open_video(write("both.mkv", {.has_sound = true}, 5)).value();  // which lasts longer than the images
  EXPECT_EQ(times_ms(both).size(), 5u);
  EXPECT_FALSE(both.truncated());
}

TEST_F(VideoFileTest, NamesMayHoldAnything) {
  const std::string path = write("a b:50%d ü#?.mp4", {});
  Video video = open_video(path).value();
  EXPECT_EQ(times_ms(video).size(), 3u);
  VideoWriter writer = create_video(folder_ / "c 50%d:é.mp4", 64, 48, 30).value();
  writer.write(corners(64, 48)).value();
  ASSERT_TRUE(writer.close().ok());
  EXPECT_TRUE(fs::exists(folder_ / "c 50%d:é.mp4"));
}

TEST_F(VideoFileTest, WithoutItsIndexAnMp4IsCutOff) {
  const std::string path = write("cut.mp4", {}, 30);
  fs::resize_file(path, fs::file_size(path) / 2);
  EXPECT_THAT(open_video(path).error().message,
              EndsWith("cut.mp4: the file is cut off or damaged: its index cannot be read"));
}

TEST_F(VideoFileTest, CutStreamsGiveWhatIsThereAndSaySo) {
  std::vector<ByteImage> images;
  for (int i = 0; i < 60; ++i) {
    images.push_back(corners(64, 48));
    for (int x = 0; x < 64; ++x) images.back().at(x, i * 3 % 48, 1) = static_cast<uint8_t>(i * 37 + x * 5);
  }
  const fs::path path = folder_ / "cut.mkv";
  write_clip_for_test(path, images, {});
  fs::resize_file(path, fs::file_size(path) / 2);
  Video video = open_video(path.string()).value();
  const size_t count = times_ms(video).size();
  EXPECT_GT(count, 10u);
  EXPECT_LT(count, 50u);
  EXPECT_TRUE(video.truncated());
  EXPECT_THAT(video.warnings(), testing::Contains(EndsWith("cut.mkv: breaks off before its end")));
}

TEST_F(VideoFileTest, FullDiskIsAnError) {
  fs::create_symlink("/dev/full", folder_ / "full.mp4");
  Result<VideoWriter> writer = create_video(folder_ / "full.mp4", 64, 48, 30);
  Result<void> written;
  if (writer) {
    written = writer->write(corners(64, 48));
    if (written) written = writer->close();
  }
  const std::string message = writer ? written.error().message : writer.error().message;
  EXPECT_THAT(message, HasSubstr("full.mp4: not writable ("));
}

TEST_F(VideoFileTest, MetadataTellTheFocalLength) {
  const char* const key = "com.apple.quicktime.camera.focal_length.35mm_equivalent";
  const std::pair<const char*, std::optional<double>> cases[] = {
      {"28", 28}, {"25.5", 25.5}, {"0", std::nullopt}, {"nan", std::nullopt}, {"wide", std::nullopt}};
  for (const auto& [value, expected] : cases) {
    const std::string path = write("phone.mov", {.metadata = {{key, value}}});
    EXPECT_EQ(open_video(path).value().focal_mm35(), expected) << value;
  }
  EXPECT_EQ(open_video(write("plain.mov", {})).value().focal_mm35(), std::nullopt);
}

TEST_F(VideoFileTest, ExifOfTheFirstJpegTellsTheFocalLength) {
  // Big-endian TIFF: IFD0 at 8 with the pointer to Exif's IFD at 26, which holds 0xA405, a SHORT.
  const auto exif = [](char mm) {
    return std::string("Exif\0\0MM\0\x2a\0\0\0\x08", 14) +
           std::string("\0\x01\x87\x69\0\x04\0\0\0\x01\0\0\0\x1a\0\0\0\0", 18) +
           std::string("\0\x01\xa4\x05\0\x03\0\0\0\x01\0", 11) + mm + std::string("\0\0\0\0\0\0", 6);
  };
  const std::string jpeg = jpeg_bytes(corners(64, 48), 90);
  const auto write_jpeg = [&](const std::string& name, const std::string& segment) {
    std::ofstream stream(folder_ / name, std::ios::binary);
    stream << jpeg.substr(0, 2);
    if (!segment.empty()) stream << "\xff\xe1" << '\0' << static_cast<char>(segment.size() + 2) << segment;
    stream << jpeg.substr(2);
  };
  write_jpeg("a.jpg", exif(27));
  write_jpeg("b.jpg", {});
  EXPECT_EQ(open_video(folder_.string()).value().focal_mm35(), 27);
  write_jpeg("a.jpg", exif(0));
  EXPECT_EQ(open_video(folder_.string()).value().focal_mm35(), std::nullopt);
  write_jpeg("a.jpg", {});
  EXPECT_EQ(open_video(folder_.string()).value().focal_mm35(), std::nullopt);
}

}  // namespace
}  // namespace silpose
