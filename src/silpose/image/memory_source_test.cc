#include "silpose/image/memory_source.h"

#include <gmock/gmock.h>

namespace silpose {
namespace {

std::vector<ByteImage> three_images() {
  std::vector<ByteImage> images;
  for (const int grey : {10, 20, 30}) images.emplace_back(4, 3, 3, static_cast<uint8_t>(grey));
  return images;
}

TEST(MemorySource, GivesItsImagesOverAgain) {
  MemorySource source(three_images(), 25, {}, "frames");
  EXPECT_EQ(source.name(), "frames");
  EXPECT_EQ(source.fps(), 25);
  EXPECT_EQ(source.num_frames_hint(), 3);
  for (int pass = 0; pass < 2; ++pass) {
    for (const int grey : {10, 20, 30}) {
      const std::optional<TimedImage> image = source.next().value();
      EXPECT_EQ(image.value().image.at(3, 2, 1), grey);
      EXPECT_EQ(image->time_ns, std::nullopt);
    }
    EXPECT_FALSE(source.next().value().has_value());
    source.rewind().value();
  }
}

TEST(MemorySource, TimesCountFromTheFirstImage) {
  MemorySource source(three_images(), 0, {500, 600, 900});
  EXPECT_TRUE(source.has_times());
  std::vector<int64_t> times;
  while (const auto image = source.next().value()) times.push_back(image->time_ns.value());
  EXPECT_THAT(times, testing::ElementsAre(0, 100, 400));
}

TEST(MemorySource, RefusesWhatDoesNotFit) {
  EXPECT_THROW(MemorySource(three_images(), -1), std::invalid_argument);
  EXPECT_THROW(MemorySource(three_images(), 0, {1, 2}), std::invalid_argument);
  EXPECT_THROW(MemorySource(three_images(), 0, {1, 2, 2}), std::invalid_argument);
  EXPECT_THROW(MemorySource({ByteImage(4, 3, 1)}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
