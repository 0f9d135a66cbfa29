#include "silpose/recording/track_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sadb/store/memory_store.h"

namespace silpose {
namespace {

using testing::HasSubstr;

// Moves and turns without end.
Skeleton two_dofs() {
  Joint root{.name = "root", .dof_indices = {0, 1}};
  Dof move{.name = "root_tx", .is_translation = true, .lower = -1, .upper = 1};
  Dof turn{.name = "root_ry", .is_periodic = true, .axis = Eigen::Vector3d::UnitY(), .lower = -kPi, .upper = kPi};
  return Skeleton("human", {root}, {move, turn});
}

StepReport tracked(int64_t frame) {
  StepReport report;
  report.frame_idx = frame;
  report.time_ns = frame * 33'333'333;
  report.state = StepReport::State::kTracked;
  report.pose = {0.1, static_cast<double>(frame)};
  report.mode = {0.2, static_cast<double>(frame)};
  report.spread = {0.3, 0.4};
  report.landmark_spread = {{1, 2, 3}, {4, 5, 6}};
  report.effective_sample_size = 77;
  report.visual_accuracy = 0.9;
  report.trust = {Trust{.overall = 0.5}};
  report.observed = {mask_from_text("#.\n.#")};
  return report;
}

TEST(TrackRecorder, WhatGoesInComesBack) {
  const auto board = std::make_shared<sadb::MemoryStore>();
  TrackRecorder recorder(board, two_dofs(), {"front"});
  StepReport waiting;
  waiting.frame_idx = 3;
  waiting.time_ns = 3 * 33'333'333;
  ASSERT_TRUE(recorder.put(waiting));
  ASSERT_TRUE(recorder.put(tracked(4)));

  const TrackRecording recording = read_recording(*board).value();
  EXPECT_EQ(recording.skeleton, "human");
  ASSERT_EQ(recording.steps.size(), 2u);
  EXPECT_EQ(recording.steps[0].frame_idx, 3);
  EXPECT_EQ(recording.steps[0].state, StepReport::State::kWaiting);
  EXPECT_TRUE(recording.steps[0].pose.empty());
  const RecordedStep& step = recording.steps[1];
  EXPECT_EQ(step.time_ns, 4 * 33'333'333);
  EXPECT_EQ(step.state, StepReport::State::kTracked);
  EXPECT_EQ(step.pose, (std::vector<double>{0.1, 4}));
  EXPECT_EQ(step.mode, (std::vector<double>{0.2, 4}));
  EXPECT_EQ(step.spread, (std::vector<double>{0.3, 0.4}));
  ASSERT_EQ(step.landmark_spread.size(), 2u);
  EXPECT_EQ(step.landmark_spread[1], Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(step.visual_accuracy, 0.9);
  EXPECT_EQ(step.effective_sample_size, 77);
  EXPECT_EQ(recording.cameras, std::vector<std::string>{"front"});
  EXPECT_EQ(step.trust, std::vector<double>{0.5});
  ASSERT_EQ(recording.steps[0].trust.size(), 1u);
  EXPECT_TRUE(std::isnan(recording.steps[0].trust[0]));
}

TEST(TrackRecorder, MasksAndTrustAreEntriesOfTheirCamera) {
  const auto board = std::make_shared<sadb::MemoryStore>();
  ASSERT_TRUE(TrackRecorder(board, two_dofs(), {"front"}, {.prefix = "cell/1"}).put(tracked(4)));
  const auto mask = board->get("cell/1/observed/front", 0, {sadb::Method::kLatest}).value();
  EXPECT_EQ(text_from_mask(*std::get<sadb::Shared<Mask>>(mask.value)), text_from_mask(mask_from_text("#.\n.#")));
  EXPECT_EQ(std::get<double>(board->get("cell/1/trust/front", 0, {sadb::Method::kLatest}).value().value), 0.5);

  const auto lean = std::make_shared<sadb::MemoryStore>();
  ASSERT_TRUE(TrackRecorder(lean, two_dofs(), {"front"}, {.masks = false}).put(tracked(4)));
  EXPECT_EQ(lean->count("tracker/observed/front").value(), 0);
}

TEST(TrackRecorder, PosesHaveTheSchemaOfTheSkeleton) {
  const auto board = std::make_shared<sadb::MemoryStore>();
  TrackRecorder recorder(board, two_dofs(), {"front"});
  ASSERT_TRUE(recorder.put(StepReport{}));  // waiting: declared, without entries
  const sadb::Schema schema = board->schema("tracker/pose").value();
  using Kind = sadb::PoseDof::Kind;
  EXPECT_EQ(schema,
            (sadb::Schema{sadb::Type::kPose, sadb::PoseSchema{"human",
                                                              {{"root_tx", Kind::kTranslation, "m", 0},
                                                               {"root_ry", Kind::kRotation, "rad", 2 * kPi}}}}));
  EXPECT_EQ(board->schema("tracker/mode").value(), schema);

  StepReport before = tracked(1), after = tracked(3);
  before.pose = {0, to_radians(170)};
  after.pose = {0.5, to_radians(-170)};
  ASSERT_TRUE(recorder.put(before));
  ASSERT_TRUE(recorder.put(after));
  const auto between = board->get("tracker/pose", 2 * 33'333'333, {sadb::Method::kLinear}).value();
  const std::vector<double> values = std::get<sadb::Pose>(between.value).values;
  EXPECT_NEAR(values[0], 0.25, 1e-12);
  EXPECT_NEAR(values[1], kPi, 1e-12);

  sadb::PoseDof other{"root_tx"};
  const auto taken = std::make_shared<sadb::MemoryStore>();
  ASSERT_TRUE(taken->declare("tracker/pose", {sadb::Type::kPose, sadb::PoseSchema{"snake", {other}}}));
  EXPECT_THAT(TrackRecorder(taken, two_dofs(), {}).put(StepReport{}).error().message,
              HasSubstr("tracker/pose: has another schema"));
}

TEST(TrackRecorder, AStepIsOneBatch) {
  const auto board = std::make_shared<sadb::MemoryStore>();
  const auto subscription = board->watch("tracker", {.capacity = 1}).value();  // keeps the last put, whole
  TrackRecorder recorder(board, two_dofs(), {"front"});
  ASSERT_TRUE(recorder.put(StepReport{}));
  ASSERT_TRUE(recorder.put(tracked(4)));
  const sadb::Update update = subscription->next(std::chrono::nanoseconds(0)).value();
  EXPECT_EQ(update.num_dropped, 4);
  EXPECT_EQ(update.entries.size(), 10u);
  for (const sadb::PathEntry& entry : update.entries) EXPECT_EQ(entry.time_ns, 4 * 33'333'333) << entry.path;
}

TEST(TrackRecorder, NothingOrSomethingElseIsAnError) {
  sadb::MemoryStore board;
  EXPECT_THAT(read_recording(board, "elsewhere").error().message, HasSubstr("elsewhere"));
  ASSERT_TRUE(board.put("tracker/frame", 0, std::string("first")));
  EXPECT_THAT(read_recording(board).error().message, HasSubstr("tracker/frame"));
  sadb::MemoryStore strange;
  ASSERT_TRUE(strange.put("tracker/frame", 0, 0.0));
  ASSERT_TRUE(strange.put("tracker/state", 0, std::string("asleep")));
  EXPECT_THAT(read_recording(strange).error().message, HasSubstr("asleep"));
}

TEST(TrackRecorder, MoreCamerasThanNamesIsTheCallersMistake) {
  TrackRecorder recorder(std::make_shared<sadb::MemoryStore>(), two_dofs(), {});
  EXPECT_THROW((void)recorder.put(tracked(0)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
