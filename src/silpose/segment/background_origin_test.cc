#include "silpose/segment/background_origin.h"

#include <gmock/gmock.h>

namespace silpose {
namespace {

TEST(BackgroundOrigin, RoundTrip) {
  for (const char* text : {"auto", "online", "online:knn", "lead-in:1.5", "plates/empty.png"}) {
    EXPECT_EQ(text_of(background_origin_of(text).value()), text);
  }
  EXPECT_EQ(std::get<BackgroundLeadIn>(background_origin_of("lead-in:1.5").value()).seconds, 1.5);
  EXPECT_EQ(std::get<BackgroundPlate>(background_origin_of("on.png").value()).path, "on.png");
}

TEST(BackgroundOrigin, RefusesALeadInWithoutALength) {
  for (const char* text : {"lead-in:", "lead-in:0", "lead-in:-1", "lead-in:1s", "lead-in:nan", "lead-in:inf"}) {
    EXPECT_THAT(background_origin_of(text).error().message,
                testing::HasSubstr(std::string(text) + "': lead-in wants a positive number of seconds"));
  }
}

}  // namespace
}  // namespace silpose
