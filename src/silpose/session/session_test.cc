#include "silpose/session/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "sadb/store/memory_store.h"
#include "silpose/base/folder_for_test.h"
#include "silpose/session/board_sink.h"
#include "silpose/session/session_for_test.h"

namespace silpose {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<int64_t> numbers(int64_t count) {
  std::vector<int64_t> all(static_cast<size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

class SessionTest : public FolderTest {
 protected:
  // One camera per source.
  std::unique_ptr<ObservationSource> observe(std::vector<TubeSource::Options> cameras, SourceOptions options = {}) {
    std::vector<std::unique_ptr<FrameSource>> sources;
    for (const auto& camera : cameras) {
      counts_.push_back(std::make_shared<PassCounts>());
      sources.push_back(std::make_unique<TubeSource>(camera, counts_.back()));
    }
    for (SegmenterOptions& segmenter : options.segmenters) segmenter.kind = "masks";
    return ObservationSource::open(join_sources(std::move(sources)).value(), std::move(options)).value();
  }

  SessionOptions options(int num_cameras = 1) {
    SessionOptions options;
    options.tracker.body = std::make_shared<BodyModel>(make_test_body());
    for (int c = 0; c < num_cameras; ++c) options.tracker.cameras.push_back(tube_camera(c));
    options.tracker.fitted()->num_hypotheses = 2;
    options.tracker.proposal = std::make_shared<TubeStarts>();
    options.sinks = {sink_};
    return options;
  }
  SessionOptions smoothed(int num_cameras = 1) {
    SessionOptions whole = options(num_cameras);
    whole.tracker.fitted()->smooth = true;
    return whole;
  }
  SessionOptions with_checkpoint(SessionOptions options) {
    const auto masks = std::make_shared<MaskFiles>(folder_, options.tracker.cameras);
    options.sinks.push_back(masks);
    options.checkpoint = {folder_, made_with(options.tracker.cameras, *options.tracker.body), masks};
    return options;
  }

  static std::vector<StepReport> all_reports(Session& session) {
    std::vector<StepReport> reports;
    while (const std::optional<StepReport> report = session.next().value()) reports.push_back(*report);
    return reports;
  }

  std::vector<std::shared_ptr<PassCounts>> counts_;  // of each source
  std::shared_ptr<RecordingSink> sink_ = std::make_shared<RecordingSink>();
};

// Fails the test where a start is searched.
class NoStarts : public Proposal {
 public:
  Proposed propose(const ProposalContext& /*context*/, int /*count*/, Rng& /*rng*/) const override {
    ADD_FAILURE() << "a start is searched";
    return {StateBatch::Zero(1, 8)};
  }
};

// Poses, bit for bit.
void expect_same(const TrackRecording& first, const TrackRecording& second) {
  ASSERT_EQ(first.steps.size(), second.steps.size());
  for (size_t t = 0; t < first.steps.size(); ++t) {
    EXPECT_EQ(first.steps[t].frame_idx, second.steps[t].frame_idx);
    EXPECT_EQ(first.steps[t].time_ns, second.steps[t].time_ns);
    EXPECT_EQ(first.steps[t].pose, second.steps[t].pose) << t;
    EXPECT_EQ(first.steps[t].spread, second.steps[t].spread) << t;
  }
}

TEST_F(SessionTest, TracksFrameByFrame) {
  const auto source = observe({{}});
  Session session(*source, options());
  const std::vector<StepReport> reports = all_reports(session);
  ASSERT_EQ(reports.size(), 12u);
  for (size_t t = 0; t < reports.size(); ++t) {
    EXPECT_EQ(reports[t].frame_idx, static_cast<int64_t>(t));
    EXPECT_GT(reports[t].visual_accuracy, 0.85) << t;
    EXPECT_NEAR(reports[t].pose[0], tube_pose(static_cast<int64_t>(t))[0], 0.05) << t;
  }
  const SessionResult result = session.finish().value();
  EXPECT_FALSE(result.stopped);
  EXPECT_EQ(result.num_frames, 12);
  EXPECT_EQ(result.recording.steps.size(), 12u);
  EXPECT_EQ(sink_->observed, numbers(12));
  EXPECT_EQ(sink_->reported, numbers(12));
  EXPECT_EQ(sink_->tracked, numbers(12));
  EXPECT_TRUE(sink_->is_finished);
}

// finish() alone tracks the same, and the same again.
TEST_F(SessionTest, FinishTracksWhatIsLeft) {
  const auto source = observe({{}}), again = observe({{}});
  Session session(*source, options()), stepped(*again, options());
  for (int t = 0; t < 5; ++t) ASSERT_TRUE(stepped.next().value().has_value());
  expect_same(session.finish().value().recording, stepped.finish().value().recording);
}

TEST_F(SessionTest, EveryFrameIsReadOncePerPass) {
  const auto online = observe({{}});
  EXPECT_EQ(counts_[0]->images, 1) << "the first one, which says how large they are, is kept";
  Session(*online, options()).finish().value();
  EXPECT_EQ(counts_[0]->images, 12) << "segmented, tracked and drawn in one pass";
  const auto whole = observe({{}});
  Session(*whole, smoothed()).finish().value();
  EXPECT_EQ(counts_[1]->images, 2 * 12) << "the smoothed poses are drawn in a pass of their own";
  sink_->needs_frames = false;
  const auto undrawn = observe({{}});
  Session(*undrawn, smoothed()).finish().value();
  EXPECT_EQ(counts_[2]->images, 12) << "nothing is drawn";
}

TEST_F(SessionTest, SmoothsAClipAsAWhole) {
  const auto source = observe({{}});
  Session session(*source, smoothed());
  const std::vector<StepReport> reports = all_reports(session);
  ASSERT_EQ(reports.size(), 12u);
  EXPECT_EQ(sink_->observed, numbers(12));
  EXPECT_THAT(sink_->tracked, ElementsAre()) << "drawn by finish()";
  EXPECT_EQ(session.finish().value().recording.steps.size(), 12u);
  EXPECT_EQ(sink_->tracked, numbers(12));
}

TEST_F(SessionTest, StopsAfterTheFrameInWhichItIsAskedTo) {
  for (const int64_t stop : {0, 1, 7}) {
    StoppingProgress progress("tracking", stop);
    const auto source = observe({{}});
    SessionOptions stopping = options();
    stopping.progress = &progress;
    sink_->observed.clear();
    const SessionResult result = Session(*source, std::move(stopping)).finish().value();
    EXPECT_TRUE(result.stopped);
    EXPECT_EQ(result.num_frames, stop);
    EXPECT_EQ(std::ssize(result.recording.steps), stop);
    EXPECT_EQ(sink_->observed, numbers(stop));
  }
}

// Stopped anywhere, a session is resumed to the same bits.
TEST_F(SessionTest, ResumesWhereItWasStopped) {
  struct Case {
    bool is_smoothed;
    const char* what;
    int64_t stop;
    const char* where;
  };
  for (const Case& test :
       {Case{false, "tracking", 5, "after frame 4"}, Case{true, "segmenting", 7, "after frame 6"},
        Case{true, "tracking", 9, "in the pass over the whole clip"}, Case{true, "writing", 3, "with the overlay"}}) {
    const auto chosen = [&] { return with_checkpoint(test.is_smoothed ? smoothed() : options()); };
    const auto source = observe({{}}), first = observe({{}}), second = observe({{}});
    const SessionResult whole = Session(*source, test.is_smoothed ? smoothed() : options()).finish().value();
    StoppingProgress progress(test.what, test.stop);
    SessionOptions stopping = chosen();
    stopping.progress = &progress;
    EXPECT_TRUE(Session(*first, std::move(stopping)).finish().value().stopped) << test.where;

    const SessionOptions resuming = chosen();
    auto earlier = read_checkpoint(folder_, resuming.checkpoint->made_with).value();
    ASSERT_TRUE(earlier.has_value()) << test.where;
    sink_->tracked.clear();
    Session session(*second, resuming);
    EXPECT_EQ(session.resume(std::move(*earlier)).value(), test.where);
    const SessionResult resumed = session.finish().value();
    EXPECT_FALSE(resumed.stopped);
    expect_same(whole.recording, resumed.recording);
    EXPECT_EQ(sink_->tracked, numbers(12)) << test.where;
  }
}

TEST_F(SessionTest, AnotherClipIsNotResumed) {
  StoppingProgress progress("tracking", 5);
  SessionOptions stopping = with_checkpoint(options());
  stopping.progress = &progress;
  const auto source = observe({{}});
  Session(*source, std::move(stopping)).finish().value();
  const SessionOptions resuming = with_checkpoint(options());
  const auto earlier = read_checkpoint(folder_, resuming.checkpoint->made_with).value();

  const auto shorter = observe({{.num_frames = 3}});
  EXPECT_THAT(Session(*shorter, resuming).resume(*earlier).error().message, HasSubstr("ends at frame 3"));
  const auto other = observe({{.camera = 1}});
  EXPECT_THAT(Session(*other, resuming).resume(*earlier).error().message, HasSubstr("frame 4 of tube is not the one"));
  MadeWith otherwise = resuming.checkpoint->made_with;
  otherwise.emplace_back("--hypotheses", "3");
  EXPECT_THAT(read_checkpoint(folder_, otherwise).error().message,
              HasSubstr("can only be resumed as it was started; --hypotheses: was not given, now 3"));
}

TEST_F(SessionTest, AFullDiskEndsIt) {
  for (const bool is_smoothed : {false, true}) {
    const auto source = observe({{}});
    sink_ = std::make_shared<RecordingSink>();
    sink_->fails_at = 4;
    Session session(*source, is_smoothed ? smoothed() : options());
    const Result<SessionResult> result = session.finish();
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().message, "no space left on device");
    EXPECT_EQ(sink_->observed, numbers(4));
    EXPECT_FALSE(sink_->is_finished);
  }
}

TEST_F(SessionTest, ASourceThatFailsInTheMiddleEndsItAfterTheFramesBefore) {
  const auto source = observe({{.fails_at = 6}});
  Session session(*source, options());
  for (int t = 0; t < 6; ++t) ASSERT_TRUE(session.next().value().has_value()) << t;
  const auto failed = session.next();
  ASSERT_FALSE(failed.ok());
  EXPECT_EQ(failed.error().message, "tube: frame 6 is damaged");
  EXPECT_EQ(session.next().error().message, "tube: frame 6 is damaged") << "it is over";
  EXPECT_EQ(session.finish().error().message, "tube: frame 6 is damaged");
  EXPECT_EQ(sink_->observed, numbers(6));
  EXPECT_FALSE(sink_->is_finished);
}

TEST_F(SessionTest, TwoCamerasOfWhichOneEndsAreTrackedAsLongAsBothSee) {
  const auto source = observe({{.camera = 0}, {.camera = 1, .num_frames = 7}});
  Session session(*source, options(2));
  const SessionResult result = session.finish().value();
  EXPECT_EQ(result.num_frames, 7);
  ASSERT_EQ(result.recording.steps.size(), 7u);
  EXPECT_EQ(sink_->num_cameras, 2u);
  for (const RecordedStep& step : result.recording.steps) {
    EXPECT_NEAR(step.pose[2], 0, 0.02) << "the second camera sees how far away it is";
  }
}

TEST_F(SessionTest, AStretchOfAClip) {
  const auto source = observe({{}}, {.start_s = 0.1, .end_s = 0.2});
  Session(*source, options()).finish().value();
  EXPECT_THAT(sink_->observed, ElementsAre(3, 4, 5, 6));
}

TEST_F(SessionTest, NoFrameIsNoError) {
  const auto source = observe({{}}, {.start_s = 100});
  const SessionResult result = Session(*source, smoothed()).finish().value();
  EXPECT_EQ(result.num_frames, 0);
  EXPECT_TRUE(result.recording.steps.empty());
}

TEST_F(SessionTest, TheGivenPoseIsTheFirst) {
  const auto source = observe({{}}, {.start_s = 0.1});
  SessionOptions given = options();
  std::vector<int64_t> asked;
  given.initial_pose = [&](int64_t frame) -> Result<std::optional<std::vector<double>>> {
    asked.push_back(frame);
    return std::optional(tube_pose(frame));
  };
  given.tracker.proposal = std::make_shared<NoStarts>();
  Session session(*source, std::move(given));
  const StepReport first = session.next().value().value();
  EXPECT_THAT(asked, ElementsAre(3));
  EXPECT_EQ(first.state, StepReport::State::kInitialised);
  for (size_t d = 0; d < first.pose.size(); ++d) EXPECT_NEAR(first.pose[d], tube_pose(3)[d], 0.1) << d;
}

TEST_F(SessionTest, AFailingInitialPoseIsAnError) {
  const auto source = observe({{}});
  SessionOptions failing = options();
  failing.initial_pose = [](int64_t) -> Result<std::optional<std::vector<double>>> {
    return error("poses.csv: empty");
  };
  EXPECT_EQ(Session(*source, std::move(failing)).next().error().message, "poses.csv: empty");
}

// A board beside a session holds what the session reports.
TEST_F(SessionTest, ABoardReceivesTheRecording) {
  const auto source = observe({{}});
  const auto board = std::make_shared<sadb::MemoryStore>();
  SessionOptions recorded = options();
  recorded.sinks.push_back(
      std::make_shared<BoardSink>(board, recorded.tracker.body->skeleton, std::vector<std::string>{"front"}));
  const SessionResult result = Session(*source, std::move(recorded)).finish().value();
  const TrackRecording read = read_recording(*board).value();
  expect_same(result.recording, read);
  EXPECT_EQ(board->count("tracker/observed/front").value(), 12);
  EXPECT_EQ(read.cameras, result.recording.cameras);
  EXPECT_EQ(read.skeleton, result.recording.skeleton);
  for (size_t t = 0; t < read.steps.size(); ++t) EXPECT_EQ(read.steps[t].trust, result.recording.steps[t].trust);
}

}  // namespace
}  // namespace silpose
