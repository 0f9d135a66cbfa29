#include "silpose/calibrate/focal_prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace silpose {
namespace {

TEST(FocalPrior, CoversCalibratedPhonesEitherWayUp) {
  for (const auto& [width, height] : {std::pair(1920, 1080), std::pair(1080, 1920)}) {
    const FocalPrior prior = usual_focal_length(width, height);
    EXPECT_DOUBLE_EQ(prior.focal_px, 0.75 * 1920);
    for (const double phone : {0.67, 0.72}) EXPECT_LT(std::abs(std::log(phone / 0.75)), prior.deviation);
  }
  EXPECT_DOUBLE_EQ(usual_focal_length(640, 480).focal_px, 0.75 * 640);
}

TEST(FocalPrior, SquareImageIsCropped) {
  const FocalPrior square = usual_focal_length(720, 720);
  EXPECT_GT(square.focal_px, usual_focal_length(960, 720).focal_px);
  EXPECT_LT(square.focal_px, usual_focal_length(1280, 720).focal_px);
  EXPECT_GT(square.deviation, usual_focal_length(1280, 720).deviation);
}

TEST(FocalPrior, FilmEquivalentIsByTheDiagonal) {
  // 50 mm before 36 x 24 mm; the same angle over the diagonal of 1500 px.
  EXPECT_NEAR(focal_px_of_mm35(50, 3600, 2400), 5000, 0.1);
  EXPECT_NEAR(focal_px_of_mm35(43.2666, 1200, 900), 1500, 0.01);
  const FocalPrior prior = focal_length_of_metadata(43.2666, 900, 1200);
  EXPECT_NEAR(prior.focal_px, 1500, 0.01);
  EXPECT_DOUBLE_EQ(prior.deviation, 0.08);
}

TEST(FocalPrior, ViewIsAlongTheLargerSide) {
  EXPECT_NEAR(focal_px_of_view(0.5 * std::numbers::pi, 1280, 720), 640, 1e-9);
  EXPECT_NEAR(focal_px_of_view(0.5 * std::numbers::pi, 720, 1280), 640, 1e-9);
  EXPECT_NEAR(focal_px_of_view(2 * std::atan(0.5), 1000, 10), 1000, 1e-9);
}

TEST(FocalPrior, RefusesWhatIsNoCamera) {
  EXPECT_THROW((void)usual_focal_length(0, 10), std::invalid_argument);
  EXPECT_THROW((void)focal_px_of_mm35(0, 10, 10), std::invalid_argument);
  EXPECT_THROW((void)focal_px_of_view(std::numbers::pi, 10, 10), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
