#include "silpose/session/track_job.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "silpose/base/folder_for_test.h"
#include "silpose/base/option_error.h"
#include "silpose/base/text_file.h"
#include "silpose/exchange/tables.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/image/image_file.h"
#include "silpose/session/session_for_test.h"
#include "silpose/session/subject_fit.h"
#include "silpose/session/track_result.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A clip of the tube on disk: masks, camera, body and true poses.
class TrackJobTest : public FolderTest {
 protected:
  static constexpr int kFrames = 5;

  TrackJobTest() {
    const BodyModel body = make_test_body();
    write_body(at("tube.body"), body).value();
    write_cameras(at("camera.toml"), {tube_camera(0)}).value();
    fs::create_directories(at("clip"));
    fs::create_directories(at("out"));
    PoseTable poses;
    for (int64_t t = 0; t < kFrames; ++t) {
      write_mask(folder_ / "clip" / fmt::format("{:06}.png", t), render_silhouette(body, tube_camera(0), tube_pose(t)))
          .value();
      poses.rows.push_back({.frame = t, .time_s = static_cast<double>(t) / 30, .values = tube_pose(t)});
    }
    write_poses(at("poses.csv"), body.skeleton, poses).value();
  }

  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }

  [[nodiscard]] TrackOptions options() const {
    TrackOptions options;
    options.input.videos = {at("clip")};
    options.input.segmentation.segmenter = "masks";
    options.input.default_fps = 30;
    options.camera.file = at("camera.toml");
    options.model = at("tube.body");
    options.init = at("poses.csv");
    options.tracker["hypotheses"] = int64_t{1};
    return options;
  }
  [[nodiscard]] CheckpointPlace place(const TrackJob& job) const {
    return {at("out"), made_with(job.cameras.cameras, *job.body),
            std::make_shared<MaskFiles>(at("out"), job.cameras.cameras)};
  }
};

TEST_F(TrackJobTest, MakesTheFilesAndFactsOfAResult) {
  const TrackJob job = prepare_track(options(), {}).value();
  EXPECT_EQ(job.tracker.fitted()->num_hypotheses, 1);
  EXPECT_FALSE(job.options.fit_body.value());
  const CheckpointPlace place = this->place(job);
  const SessionResult result = run_track(job, place, false, {}).value();
  EXPECT_EQ(result.num_frames, kFrames);
  EXPECT_EQ(result.recording.steps.size(), static_cast<size_t>(kFrames));

  const ProgramRun program = {.version = "1.2", .command_line = "silpose track clip"};
  const FinishedTrack track{
      program, job, *place.masks, result, chosen_options(job.options, result.used), warnings_of(job, result)};
  EXPECT_THAT(track.warnings, ElementsAre(HasSubstr("no motion.mot")));
  const nlohmann::ordered_json facts = facts_of(track, "out");
  EXPECT_EQ(facts["command"], "silpose track clip");
  EXPECT_EQ(facts["frames"], kFrames);
  EXPECT_EQ(facts["frames_tracked"], kFrames);
  EXPECT_EQ(facts["cameras"].dump(), R"(["front"])");
  EXPECT_EQ(facts["background"], "masks");
  EXPECT_EQ(facts["evidence"], "silhouette");
  EXPECT_GT(facts["visual_accuracy"]["mean"], 0.9);
  EXPECT_FALSE(facts.contains("focal_prior")) << "the camera is that of a file";

  ASSERT_TRUE(write_track_report(track, at("out")).ok());
  for (const char* file :
       {"poses.csv", "joints.csv", "camera.toml", "overlay.mp4", "report.html", "masks/000004.png"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
  }
  EXPECT_THAT(read_text_file(at("out/report.html")).value(), HasSubstr("silpose track clip"));
}

TEST_F(TrackJobTest, WarnsOfACameraThatIsAssumed) {
  TrackOptions assumed = options();
  assumed.camera.file = kAssumedCamera;
  const TrackJob job = prepare_track(assumed, {}).value();
  EXPECT_FALSE(job.tracker.has_floor());
  EXPECT_FALSE(job.cameras.estimate.has_value());
  EXPECT_THAT(job.cameras.warnings, Contains(HasSubstr("assumed a level camera")));
}

TEST_F(TrackJobTest, FindsFaultsBeforeItTracks) {
  const auto refusal = [](const TrackOptions& options) { return prepare_track(options, {}).error().message; };
  TrackOptions wrong = options();
  wrong.init = at("absent.csv");
  EXPECT_THAT(refusal(wrong), HasSubstr("absent.csv"));
  wrong = options();
  wrong.input.videos = {at("absent.mp4")};
  EXPECT_THAT(refusal(wrong), HasSubstr("absent.mp4"));
  wrong = options();
  wrong.init = "landmarks";
  EXPECT_THAT(refusal(wrong), HasSubstr("--init landmarks: masks finds none"));
  wrong = options();
  wrong.fit_body = true;
  wrong.camera.file = kAssumedCamera;
  EXPECT_THROW((void)prepare_track(wrong, {}), OptionError);
}

TEST_F(TrackJobTest, StopsWhereItIsAskedAndNeedsAFrame) {
  const TrackJob job = prepare_track(options(), {}).value();
  StoppingProgress stop("tracking", 0);
  EXPECT_THAT(run_track(job, place(job), false, {.data = {}, .progress = &stop, .message = {}}).error().message,
              HasSubstr("interrupted before the first frame"));
  TrackOptions late = options();
  late.input.start_s = 100;
  const TrackJob none = prepare_track(late, {}).value();
  EXPECT_THAT(run_track(none, place(none), false, {}).error().message, HasSubstr("no frame between --start and --end"));
}

TEST_F(TrackJobTest, ASubjectIsFittedWithAFileOfCameras) {
  SubjectFitOptions fit;
  fit.input = options().input;
  fit.model = at("tube.body");
  EXPECT_THROW((void)fit_subject(fit, {}), OptionError);
  fit.camera.file = at("camera.toml");
  StoppingProgress stop("segmenting", 2);
  EXPECT_THAT(fit_subject(fit, {.data = {}, .progress = &stop, .message = {}}).error().message,
              HasSubstr("interrupted"));
  fit.input.start_s = 100;
  EXPECT_THAT(fit_subject(fit, {}).error().message, HasSubstr("no frame between --start and --end"));
}

}  // namespace
}  // namespace silpose
