#include "silpose/video/video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>

#include "silpose/base/folder_for_test.h"
#include "silpose/image/image_file.h"
#include "silpose/image/memory_source.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using testing::EndsWith;
using testing::HasSubstr;

// A dark image with a bright column at x = 4 index.
ByteImage image(int index, int width = 64, int height = 48) {
  ByteImage image(width, height, 3, 20);
  for (int y = 0; y < height; ++y) {
    for (int x = 4 * index; x < std::min(width, 4 * index + 4); ++x) image.at(x, y, 2) = 220;
  }
  return image;
}

class VideoTest : public FolderTest {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }

  [[nodiscard]] std::string write_clip(const std::string& name, int frames, double fps, int width = 64,
                                       int height = 48) const {
    VideoWriter writer = create_video(at(name), width, height, fps).value();
    for (int i = 0; i < frames; ++i) writer.write(image(i % 12, width, height)).value();
    writer.close().value();
    return at(name);
  }

  void write_images(const std::string& format, int first, int count) const {
    for (int i = first; i < first + count; ++i) {
      write_image(at(fmt::format(fmt::runtime(format), i)), image(i % 12)).value();
    }
  }
};

int64_t count_frames(Video& video) {
  int64_t count = 0;
  for (const Frame& frame : video) {
    EXPECT_EQ(frame.index, count);
    ++count;
  }
  return count;
}

TEST_F(VideoTest, FileRoundTripKeepsImagesCountAndTimes) {
  Video video = open_video(write_clip("clip.mp4", 12, 29.97)).value();
  EXPECT_EQ(video.num_cameras(), 1);
  EXPECT_EQ(video.width(), 64);
  EXPECT_EQ(video.height(), 48);
  EXPECT_NEAR(video.fps(), 29.97, 0.01);
  EXPECT_FALSE(video.fps_assumed());
  EXPECT_FALSE(video.is_live());
  EXPECT_EQ(video.num_frames_hint(), 12);
  int64_t count = 0;
  for (const Frame& frame : video) {
    ASSERT_EQ(frame.images.size(), 1u);
    EXPECT_EQ(frame.time_ns, std::llround(static_cast<double>(count) * 1e9 / video.fps()));
    // The bright column is where it was drawn: frames come in order, rows and columns are not swapped.
    const ByteImage& image = frame.images[0];
    EXPECT_GT(image.at(static_cast<int>(4 * count + 2), 24, 2), 120) << count;
    EXPECT_LT(image.at(static_cast<int>((4 * count + 32) % 64), 24, 2), 60) << count;
    ++count;
  }
  EXPECT_EQ(count, 12);
  EXPECT_FALSE(video.truncated());
  EXPECT_FALSE(video.next().value().has_value()) << "the end stays the end";
}

TEST_F(VideoTest, RewindShowsTheSameFramesAgain) {
  Video video = open_video(write_clip("clip.mp4", 6, 25)).value();
  const ByteImage first = video.next().value()->images[0];
  (void)video.next().value();
  ASSERT_TRUE(video.rewind().ok());
  EXPECT_EQ(video.next().value()->images[0], first);
  EXPECT_EQ(video.next().value()->index, 1);
}

TEST_F(VideoTest, OddSizesArePaddedByOne) {
  Video video = open_video(write_clip("odd.mp4", 3, 30, 63, 47)).value();
  EXPECT_EQ(video.width(), 64);
  EXPECT_EQ(video.height(), 48);
  VideoWriter writer = create_video(at("other.mp4"), 63, 47, 30).value();
  EXPECT_THAT(writer.write(ByteImage(64, 48, 3)).error().message, HasSubstr("an image of 64x48"));
  EXPECT_TRUE(writer.write(ByteImage(63, 47, 1)).ok());
  ASSERT_TRUE(writer.close().ok());
  EXPECT_FALSE(writer.write(ByteImage(63, 47, 3)).ok());
}

TEST_F(VideoTest, DirectoryIsReadInNameOrderAtTheDefaultRate) {
  write_image(at("b.png"), image(1)).value();
  write_image(at("a.png"), image(0)).value();
  write_image(at("c.PNG"), image(2)).value();
  std::ofstream(at("notes.txt")) << "not an image";
  Video video = open_video(folder_.string(), {.default_fps = 50}).value();
  EXPECT_TRUE(video.fps_assumed());
  EXPECT_EQ(video.num_frames_hint(), 3);
  int count = 0;
  for (const Frame& frame : video) {
    EXPECT_EQ(frame.images[0], image(count));
    EXPECT_EQ(frame.time_ns, 20'000'000 * count);
    ++count;
  }
  EXPECT_EQ(count, 3);
}

TEST_F(VideoTest, PatternFollowsTheNumbers) {
  write_images("img-{:03}.png", 8, 4);
  write_image(at("img-9.png"), image(5)).value();  // too few digits: another name
  Video video = open_video(at("img-%03d.png")).value();
  EXPECT_EQ(video.first_index(), 8);
  int index = 8;
  for (const Frame& frame : video) {
    EXPECT_EQ(frame.index, index);
    EXPECT_EQ(frame.images[0], image(index++ % 12));
  }
  EXPECT_EQ(index, 12);

  fs::remove(at("img-009.png"));
  EXPECT_THAT(open_video(at("img-%03d.png")).error().message, EndsWith("img-%03d.png: image number 9 is missing"));
  EXPECT_THAT(open_video(at("other-%d.png")).error().message, EndsWith("no image has such a name"));
}

TEST_F(VideoTest, UnpaddedPatternOrdersByNumberNotByName) {
  write_images("{}.png", 9, 2);
  Video video = open_video(at("%d.png")).value();
  EXPECT_EQ(video.next().value()->images[0], image(9));
  EXPECT_EQ(video.next().value()->images[0], image(10));
}

TEST_F(VideoTest, NumbersOfImagesAreTheirFrames) {
  for (const int i : {30, 31, 35}) write_image(at(fmt::format("walk_{:06}.png", i)), image(i % 12)).value();
  Video video = open_video(folder_.string(), {.default_fps = 10}).value();
  EXPECT_EQ(video.first_index(), 30);
  EXPECT_EQ(video.num_frames_hint(), 3);
  for (int pass = 0; pass < 2; ++pass) {
    for (const int i : {30, 31, 35}) {
      const Frame frame = video.next().value().value();
      EXPECT_EQ(frame.index, i);
      EXPECT_EQ(frame.time_ns, int64_t{100'000'000} * i);
      EXPECT_EQ(frame.images[0], image(i % 12));
    }
    EXPECT_FALSE(video.next().value().has_value());
    ASSERT_TRUE(video.rewind().ok());
  }
}

TEST_F(VideoTest, NumberedImagesComeInTheOrderOfTheirNumbers) {
  write_images("img{}.png", 9, 2);
  Video video = open_video(folder_.string()).value();
  EXPECT_EQ(video.next().value()->index, 9);
  EXPECT_EQ(video.next().value()->index, 10);

  write_image(at("img010.jpg"), image(1)).value();
  EXPECT_THAT(open_video(folder_.string()).error().message, EndsWith("img010.jpg and img10.png have the same number"));
}

TEST_F(VideoTest, OtherNamesAreCountedFromZero) {
  const std::vector<std::string> sets[] = {{"a_07.png", "b_05.png"}, {"07.png", "last.png"}, {"20240101120000.png"}};
  for (const std::vector<std::string>& names : sets) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    for (size_t i = 0; i < names.size(); ++i) write_image(at(names[i]), image(static_cast<int>(i))).value();
    Video video = open_video(folder_.string()).value();
    EXPECT_EQ(video.next().value()->images[0], image(0)) << names[0];
    EXPECT_EQ(count_frames(video = open_video(folder_.string()).value()), std::ssize(names)) << names[0];
  }
}

TEST_F(VideoTest, CamerasKeepTheNumbersThatTheyShare) {
  for (const char* name : {"a", "b", "c"}) fs::create_directories(at(name));
  write_images("a/{}.png", 5, 4);
  write_images("b/{:03}.png", 5, 3);
  write_images("c/{}.png", 6, 3);
  Video same = open_video(std::vector<std::string>{at("a"), at("b")}).value();
  EXPECT_EQ(same.first_index(), 5);
  int64_t last = 0;
  for (const Frame& frame : same) last = frame.index;
  EXPECT_EQ(last, 7);
  Video other = open_video(std::vector<std::string>{at("a"), at("c")}).value();
  EXPECT_EQ(other.next().value()->index, 0);
  EXPECT_EQ(other.own_index(0), 5);
  EXPECT_EQ(other.own_index(1), 6);
  Video mixed = open_video(std::vector<std::string>{at("a"), write_clip("clip.mp4", 4, 30)}).value();
  EXPECT_EQ(count_frames(mixed), 4);
}

TEST_F(VideoTest, ChangeOfSizeNamesTheFrame) {
  write_images("{:03}.png", 0, 2);
  write_image(at("002.png"), image(2, 32, 48)).value();
  Video video = open_video(folder_.string()).value();
  (void)video.next().value();
  (void)video.next().value();
  EXPECT_THAT(video.next().error().message, HasSubstr("frame 2 is 32x48, those before it 64x48"));
}

TEST_F(VideoTest, BrokenImageNamesTheFile) {
  write_images("{:03}.png", 0, 2);
  fs::resize_file(at("001.png"), fs::file_size(at("001.png")) / 2);
  Video video = open_video(folder_.string()).value();
  (void)video.next().value();
  EXPECT_THAT(video.next().error().message, EndsWith("001.png: the image is cut off"));
}

TEST_F(VideoTest, NamesWhatIsNotAVideo) {
  EXPECT_THAT(open_video(at("none.mp4")).error().message, EndsWith("none.mp4: no such file or directory"));
  std::ofstream(at("empty.mp4")).close();
  EXPECT_THAT(open_video(at("empty.mp4")).error().message, EndsWith("empty.mp4: the file is empty"));
  std::ofstream(at("text.txt")) << "FFmpeg would draw these letters as a video\n";
  EXPECT_THAT(open_video(at("text.txt")).error().message, EndsWith("text.txt: not a video"));
  std::ofstream noise(at("noise.mp4"), std::ios::binary);
  for (uint32_t i = 0; i < 20000; ++i) noise.put(static_cast<char>(i * i * 31 + i / 7));
  noise.close();
  EXPECT_THAT(open_video(at("noise.mp4")).error().message, HasSubstr("noise.mp4: not a video"));
  fs::create_directory(at("folder"));
  EXPECT_THAT(open_video(at("folder")).error().message, EndsWith("no images in this directory"));
  EXPECT_THAT(open_video("camera:x").error().message, EndsWith("not the number of a camera"));
  EXPECT_THAT(open_video("camera:977").error().message, EndsWith("camera:977: no such camera"));
}

TEST_F(VideoTest, BadInputPrintsNothing) {
  std::string clip = write_clip("clip.mp4", 30, 30);
  testing::internal::CaptureStderr();
  fs::resize_file(clip, fs::file_size(clip) / 2);
  EXPECT_FALSE(open_video(clip).ok());
  EXPECT_FALSE(create_video(at("no_such_folder/a.mp4"), 64, 48, 30).ok());
  EXPECT_FALSE(create_video(folder_, 64, 48, 30).ok());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Moves an MP4's index to its front, so that the file can be cut and still states how many frames it should have.
void move_index_to_front(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  const auto number = [&](size_t i) {
    uint32_t value = 0;
    for (size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<uint8_t>(bytes[i + k]);
    return value;
  };
  std::string front, index, rest;
  for (size_t i = 0; i + 8 <= bytes.size();) {
    const size_t size = number(i);
    const std::string kind = bytes.substr(i + 4, 4);
    (kind == "moov" ? index : kind == "ftyp" ? front : rest) += bytes.substr(i, size);
    i += size;
  }
  bytes = index;  // every chunk now starts one index later
  for (size_t i = bytes.find("stco"); i != std::string::npos; i = bytes.find("stco", i + 4)) {
    const uint32_t count = number(i + 8);
    for (size_t k = 0; k < count; ++k) {
      const uint32_t value = number(i + 12 + 4 * k) + static_cast<uint32_t>(index.size());
      for (size_t b = 0; b < 4; ++b) bytes[i + 12 + 4 * k + b] = static_cast<char>(value >> (24 - 8 * b));
    }
  }
  std::ofstream(path, std::ios::binary) << front << bytes << rest;
}

TEST_F(VideoTest, CutFileEndsEarlyAndSaysSo) {
  VideoWriter writer = create_video(at("clip.mp4"), 64, 48, 30).value();
  for (int i = 0; i < 120; ++i) writer.write(image(i * 7 % 16)).value();
  writer.close().value();
  move_index_to_front(at("clip.mp4"));
  Video whole = open_video(at("clip.mp4")).value();
  ASSERT_EQ(count_frames(whole), 120);
  EXPECT_FALSE(whole.truncated());

  fs::resize_file(at("clip.mp4"), fs::file_size(at("clip.mp4")) * 3 / 4);
  testing::internal::CaptureStderr();
  Video cut = open_video(at("clip.mp4")).value();
  const int64_t count = count_frames(cut);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(count, 10);
  EXPECT_LT(count, 110);
  EXPECT_EQ(cut.num_frames_hint(), 120);
  EXPECT_TRUE(cut.truncated());
}

TEST_F(VideoTest, CamerasInStepEndWithTheShortest) {
  const std::string a = write_clip("a.mp4", 8, 30), b = write_clip("b.mp4", 5, 30, 32, 32);
  Video video = open_video(std::vector<std::string>{a, b}).value();
  EXPECT_EQ(video.num_cameras(), 2);
  EXPECT_EQ(video.width(1), 32);
  EXPECT_EQ(count_frames(video), 5);
  EXPECT_FALSE(video.truncated());
  const std::string c = write_clip("c.mp4", 5, 25);
  EXPECT_THAT(open_video(std::vector<std::string>{a, c}).error().message, HasSubstr("c.mp4: 25.000 frames per second"));
}

TEST_F(VideoTest, OneImageIsAVideoOfOneFrame) {
  write_image(at("one.png"), image(3)).value();
  Video video = open_video(at("one.png")).value();
  EXPECT_EQ(video.next().value()->images[0], image(3));
  EXPECT_FALSE(video.next().value().has_value());
}

// Grey images; counts how often it went back to the first.
class CountedSource : public MemorySource {
 public:
  CountedSource(int num_frames, uint8_t grey, int& num_rewinds)
      : MemorySource(std::vector<ByteImage>(static_cast<size_t>(num_frames), ByteImage(4, 3, 3, grey)), 30),
        num_rewinds_(num_rewinds) {}
  Result<void> rewind() override {
    ++num_rewinds_;
    return MemorySource::rewind();
  }

 private:
  int& num_rewinds_;
};

Video two_cameras(int& first_rewinds, int& second_rewinds) {
  std::vector<std::unique_ptr<FrameSource>> sources;
  sources.push_back(std::make_unique<CountedSource>(5, 10, first_rewinds));
  sources.push_back(std::make_unique<CountedSource>(4, 20, second_rewinds));
  return join_sources(std::move(sources)).value();
}

TEST(JoinedSources, AreGivenInStepAsFarAsTheShortest) {
  int first = 0, second = 0;
  Video video = two_cameras(first, second);
  EXPECT_EQ(video.num_cameras(), 2);
  EXPECT_EQ(video.num_frames_hint(), 4);
  int count = 0;
  for (const Frame& frame : video) {
    EXPECT_EQ(frame.index, count++);
    EXPECT_EQ(frame.images[0].at(0, 0), 10);
    EXPECT_EQ(frame.images[1].at(0, 0), 20);
  }
  EXPECT_EQ(count, 4);
}

// A pass over one camera reads no other, and what was only read ahead is not read again.
TEST(JoinedSources, OneOfThemAlone) {
  int first = 0, second = 0;
  Video video = two_cameras(first, second);
  Video alone = video.alone(1);
  EXPECT_EQ(alone.num_cameras(), 1);
  EXPECT_EQ(alone.num_frames_hint(), 4);
  alone.rewind().value();
  EXPECT_EQ(second, 0);
  int count = 0;
  for (const Frame& frame : alone) {
    EXPECT_EQ(frame.images[0].at(0, 0), 20);
    ++count;
  }
  EXPECT_EQ(count, 4);
  video.rewind().value();
  EXPECT_EQ(first, 0);
  EXPECT_EQ(second, 1);
  count = 0;
  for (const Frame& frame : video) EXPECT_EQ(frame.index, count++);
  EXPECT_EQ(count, 4);
}

TEST(JoinedSources, RewoundAfterTheFirstFrame) {
  std::vector<ByteImage> images;
  for (const int grey : {10, 20, 30}) images.emplace_back(4, 3, 3, static_cast<uint8_t>(grey));
  std::vector<std::unique_ptr<FrameSource>> sources;
  sources.push_back(std::make_unique<MemorySource>(std::move(images), 30));
  Video video = join_sources(std::move(sources)).value();
  for (int num_read = 0; num_read < 4; ++num_read) {
    for (int i = 0; i < num_read; ++i) (void)video.next().value();
    video.rewind().value();
    const std::optional<Frame> again = video.next().value();
    EXPECT_EQ(again.value().images[0].at(0, 0), 10) << num_read;
    EXPECT_EQ(again->index, 0);
    video.rewind().value();
  }
}

// Sources of a program's own may be wrong.
class BadSource : public MemorySource {
 public:
  explicit BadSource(bool few_numbers) : MemorySource({ByteImage(4, 3, 3), ByteImage(4, 3, 3)}), few_(few_numbers) {}
  Result<std::optional<TimedImage>> next() override {
    auto image = MemorySource::next();
    if (!few_ && image && image->has_value()) (*image)->image = ByteImage(4, 3, 1);
    return image;
  }
  [[nodiscard]] std::span<const int64_t> numbers() const override {
    return few_ ? std::span<const int64_t>(&one_, 1) : std::span<const int64_t>();
  }

 private:
  bool few_;
  int64_t one_ = 5;
};

TEST(JoinedSources, ReportWhatASourceDoesWrong) {
  std::vector<std::unique_ptr<FrameSource>> sources;
  sources.push_back(std::make_unique<BadSource>(false));
  EXPECT_THAT(join_sources(std::move(sources)).error().message, HasSubstr("memory: an image of 1 channels, not of 3"));
  sources.clear();
  sources.push_back(std::make_unique<BadSource>(true));
  Video video = join_sources(std::move(sources)).value();
  EXPECT_TRUE(video.next().value().has_value());
  EXPECT_THAT(video.next().error().message, HasSubstr("memory: 1 numbers for more images"));
  sources.clear();
  EXPECT_THROW((void)join_sources(std::move(sources)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
