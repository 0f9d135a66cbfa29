#include "silpose/track/tracker_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "silpose/body/test_body.h"
#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

// What check() says; nothing where it accepts the options.
std::string refusal(TrackerOptions options, const std::function<void(TrackerOptions&)>& change) {
  static const auto kBody = std::make_shared<const BodyModel>(make_test_body());
  options.body = kBody;
  options.cameras = {default_camera(64, 48)};
  change(options);
  try {
    options.check();
  } catch (const std::invalid_argument& wrong) {
    return wrong.what();
  }
  return "";
}

TEST(TrackerOptions, ChecksNameTheOptionAndItsValue) {
  const auto with = [](const auto& change) { return refusal(default_preset(), change); };
  EXPECT_EQ(with([](TrackerOptions&) {}), "");
  EXPECT_EQ(with([](TrackerOptions& o) { o.body = nullptr; }), "no body");
  EXPECT_EQ(with([](TrackerOptions& o) { o.cameras.clear(); }), "no camera");
  EXPECT_EQ(with([](TrackerOptions& o) { o.lod_vertices = -1; }),
            "vertices: -1 is not a whole number from 0 to 1000000");
  EXPECT_EQ(with([](TrackerOptions& o) { o.lod_vertices = 99; }), "vertices: 99 is neither 0 nor at least 100");
  EXPECT_EQ(with([](TrackerOptions& o) { o.size_deviation = 1; }),
            "size deviation: 1 is not a number from 0 to below 1");
  EXPECT_EQ(with([](TrackerOptions& o) { o.initial_pose = {1, 2, 3}; }), "initial pose: 3 numbers for 8 DOF");

  const auto fitted = [](const auto& change) {
    return refusal(default_preset(), [&](TrackerOptions& o) { change(*o.fitted()); });
  };
  EXPECT_EQ(fitted([](FittedOptions& o) { o.num_hypotheses = 0; }), "hypotheses: 0 is not a whole number from 1 to 64");
  EXPECT_EQ(fitted([](FittedOptions& o) { o.num_hypotheses = 64; }), "");
  EXPECT_EQ(fitted([](FittedOptions& o) { o.num_hypotheses = 65; }),
            "hypotheses: 65 is not a whole number from 1 to 64");
}

TEST(SamplingOptions, ChecksNameTheOptionAndItsValue) {
  const auto with = [](const auto& change) {
    return refusal(annealed_preset(), [&](TrackerOptions& o) { change(*o.sampling()); });
  };
  EXPECT_EQ(with([](SamplingOptions&) {}), "");
  EXPECT_EQ(with([](SamplingOptions& o) { o.num_particles = 1; }),
            "particles: 1 is not a whole number from 2 to 1000000");
  EXPECT_EQ(with([](SamplingOptions& o) { o.num_layers = 0; }), "layers: 0 is not a whole number from 1 to 200");
  EXPECT_EQ(with([](SamplingOptions& o) { o.sigma_deg = -1; }), "sigma-deg: -1 is not a number from 0.001 to 90");
  EXPECT_EQ(with([](SamplingOptions& o) { o.sharpness = std::nan(""); }),
            "sharpness: nan is not a number from 0.001 to 1e+06");
  EXPECT_EQ(with([](SamplingOptions& o) { o.resample_below = 1.5; }),
            "resample-below: 1.5 is not a number from 0 to 1");
  EXPECT_EQ(with([](SamplingOptions& o) { o.regenerate = 1; }), "regenerate: 1 is not a number from 0 to 0.99");
  EXPECT_EQ(with([](SamplingOptions& o) { o.motion = "teleport"; }),
            "motion: 'teleport' is not one of diffusion, first-order-augmented");
  EXPECT_EQ(with([](SamplingOptions& o) { o.resampling = "best"; }),
            "resampling: 'best' is not one of comb, systematic");
  const std::string nothing_regenerated =
      "regenerate-from: network, but nothing is regenerated: it needs resampling comb and regenerate above 0";
  EXPECT_EQ(with([](SamplingOptions& o) { o.regenerate_from = RegenerateFrom::kNetwork; }), nothing_regenerated);
  EXPECT_EQ(with([](SamplingOptions& o) {
              o.regenerate_from = RegenerateFrom::kNetwork, o.resampling = "comb", o.regenerate = 0.2;
            }),
            "");
  EXPECT_EQ(with([](SamplingOptions& o) { o.separate_root = true; }),
            "layers: 10, but the thesis' two filters are plain: 1");
}

}  // namespace
}  // namespace silpose
