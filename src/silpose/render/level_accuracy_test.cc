#include "silpose/render/level_accuracy.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "silpose/base/parallel.h"

namespace silpose {
namespace {

class LevelAccuracyTest : public testing::Test {
 protected:
  BodyModel body_ = load_body(std::filesystem::path(SILPOSE_DATA_DIR) / "human.body").value();
  AccuracyOptions few_ = {.num_poses = 8, .num_views = 4, .size = 64};
};

TEST_F(LevelAccuracyTest, TheWholeBodySharesEverythingWithItself) {
  BodyLevel whole{.vertices = {}, .faces = body_.rest.faces};
  for (uint32_t v = 0; v < body_.rest.vertices.size(); ++v) whole.vertices.push_back(v);
  const LevelAccuracy accuracy = level_accuracy(body_, whole, few_);
  EXPECT_DOUBLE_EQ(accuracy.mean_iou, 1);
  EXPECT_EQ(accuracy.worst_iou, 1);
}

TEST_F(LevelAccuracyTest, MoreVerticesShareMore) {
  const LevelAccuracy coarse = level_accuracy(body_, simplify(body_, 600), few_);
  const LevelAccuracy fine = level_accuracy(body_, simplify(body_, 3000), few_);
  EXPECT_GT(coarse.mean_iou, 0.92);
  EXPECT_GT(coarse.mean_iou, coarse.worst_iou);
  EXPECT_GT(fine.mean_iou, coarse.mean_iou + 0.01);
  EXPECT_GT(fine.worst_iou, 0.96);
  EXPECT_LT(fine.mean_iou, 1);
}

TEST_F(LevelAccuracyTest, IsTheSameOnAnyNumberOfThreads) {
  const BodyLevel level = simplify(body_, 1000);
  const LevelAccuracy many = level_accuracy(body_, level, few_);
  const ThreadLimit limit(1);
  EXPECT_EQ(level_accuracy(body_, level, few_).mean_iou, many.mean_iou);
}

TEST_F(LevelAccuracyTest, RefusesNothingToCompare) {
  EXPECT_THROW((void)level_accuracy(body_, simplify(body_, 600), {.num_poses = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
