// Golden numbers: what rendering, likelihoods and the tracker give for one small scene, compared with the text files
// next to this one, within a tolerance. A change that should not change results does not touch them; one that should
// shows its effect in their diff. `golden_test --update` (scripts/golden) writes them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/text_file.h"
#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/likelihood/silhouette_likelihood.h"
#include "silpose/synth/scene.h"
#include "silpose/track/tracker.h"

namespace silpose {
namespace {

constexpr size_t kNumPoses = 10;
bool update = false;  // write the files instead of comparing with them

using Numbers = std::vector<std::pair<std::string, double>>;

// Ten poses of the average person, two seconds apart on a random smooth motion, 45 degrees from the front.
const SyntheticSequence& scene() {
  static const SyntheticSequence sequence = [] {
    const auto body = human_for_test();
    const SyntheticMotionOptions motion{.num_frames = kNumPoses, .fps = 0.5, .period_s = 5, .seed = 7};
    const SceneOptions options{.width = 320, .height = 240, .focal_px = 350, .views = {{"45", 45}}};
    return make_sequence(body, make_motion("random", *body, motion).value(), options).value();
  }();
  return sequence;
}

Observation seen(const SyntheticSequence& sequence, int frame) {
  Observation observation;
  observation.mask = true_mask(sequence, 0, frame);
  return observation;
}

// Compares with the file, or writes it. `tolerance` is absolute.
void expect_golden(const std::string& file, const std::string& what, double tolerance, const Numbers& numbers) {
  const std::filesystem::path path = std::filesystem::path(SILPOSE_GOLDEN_DIR) / file;
  if (update) {
    std::string text = fmt::format("# {} Written by scripts/golden; compared within {}.\n", what, tolerance);
    for (const auto& [name, value] : numbers) text += fmt::format("{} {:.6g}\n", name, value);
    write_text_file(path, text).value();
    return;
  }
  std::istringstream stream(read_text_file(path).value());
  std::string line;
  std::map<std::string, double> golden;
  while (std::getline(stream, line)) {
    if (line.starts_with('#')) continue;
    std::istringstream fields(line);
    std::string name;
    double value = 0;
    ASSERT_TRUE(fields >> name >> value) << file << ": " << line;
    golden[name] = value;
  }
  ASSERT_EQ(golden.size(), numbers.size()) << file;
  for (const auto& [name, value] : numbers) {
    ASSERT_TRUE(golden.contains(name)) << file << ": no " << name;
    EXPECT_NEAR(value, golden[name], tolerance) << file << ": " << name;
  }
}

TEST(Golden, PixelsOfSilhouettes) {
  Numbers numbers;
  for (size_t t = 0; t < kNumPoses; ++t) {
    numbers.emplace_back(fmt::format("pose_{}", t),
                         static_cast<double>(true_mask(scene(), 0, static_cast<int>(t)).count()));
  }
  // Vertices are rounded to 1/256 pixel: other orders of floating-point operations may change single pixels.
  expect_golden("masks.txt", "Pixels of ten silhouettes.", 2, numbers);
}

// Each pose against the silhouette of the next one: far from a fit, where all terms count. On the whole mesh: levels of
// detail depend on the version of the library that makes them.
TEST(Golden, LikelihoodsOfPoses) {
  const auto body = human_for_test();
  const SilhouetteLikelihood counts({make_cpu_backend(body, scene().cameras[0])},
                                    std::make_shared<AreaMetric>(AreaMetric::Unit::kPixels), {});
  const CoverageLikelihood coverage(body, scene().cameras);
  CoverageLikelihood::Scratch scratch(coverage);
  Numbers numbers;
  for (size_t t = 0; t < kNumPoses; ++t) {
    const Observation next = seen(scene(), static_cast<int>((t + 1) % kNumPoses));
    const std::vector<double>& pose = scene().poses[t];
    StateBatch state(1, static_cast<Eigen::Index>(pose.size()));
    state.row(0) = Eigen::Map<const Eigen::RowVectorXd>(pose.data(), state.cols());
    double log_likelihood = 0;
    counts.add_log_likelihood(*counts.prepare({&next, 1}), state, {&log_likelihood, 1});
    const double energy = coverage.energy(coverage.evidence_of({&next, 1}), Blur::k8, pose, scratch);
    numbers.emplace_back(fmt::format("pixel_count_{}", t), log_likelihood);
    numbers.emplace_back(fmt::format("log_energy_{}", t), std::log(energy));
  }
  // A pixel of some 3,000 changes the first by 40 / 6,000; the second is a logarithm: a relative tolerance.
  expect_golden("likelihoods.txt", "Log-likelihoods by counted pixels, and logarithms of coverage energies.", 0.02,
                numbers);
}

// Of the tube, which is too small to have levels of detail.
TEST(Golden, PositionsOfATrack) {
  const auto body = std::make_shared<const BodyModel>(make_test_body());
  const std::vector<PinholeCamera> cameras = {look_at_camera(320, 240, 350, {0, 1.2, 4.5}, {0, 0.75, 0}),
                                              look_at_camera(320, 240, 350, {4.5, 1.2, 0}, {0, 0.75, 0})};
  const auto truth = [](int t) {
    return std::vector<double>{0.05 * t, 0.5, 0, 0.1 * t, 0.05 * t, 0.3, -0.04 * t, 0.2};
  };
  Tracker tracker({.body = body, .cameras = cameras, .seed = 1, .initial_pose = truth(0)});
  StepReport report;
  for (int t = 0; t < 8; ++t) {
    std::vector<Observation> views;
    for (const PinholeCamera& camera : cameras) views.push_back({render_silhouette(*body, camera, truth(t))});
    report = tracker.step(views, t, t * int64_t{100'000'000});
  }
  const std::vector<std::string> names = landmark_names(*body);
  const std::vector<Eigen::Vector3d> positions = landmark_positions(*body, report.pose);
  Numbers numbers;
  for (size_t i = 0; i < names.size(); ++i) {
    for (const int k : {0, 1, 2}) {
      numbers.emplace_back(fmt::format("{}_{}", names[i], "xyz"[k]), positions[i][k]);
    }
  }
  // Metres. Rounding may be different on other machines, and a search decides by comparing.
  expect_golden("track.txt", "Landmarks in the last of eight frames, tracked by two cameras, metres.", 0.005, numbers);
}

}  // namespace
}  // namespace silpose

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  silpose::update = argc > 1 && std::string_view(argv[1]) == "--update";
  return RUN_ALL_TESTS();
}
