#include "silpose/synth/test_scene.h"

#include "silpose/body/test_body.h"

namespace silpose {

SyntheticSequence make_test_scene(int num_frames, int lead_in) {
  auto body = std::make_shared<const BodyModel>(make_test_body());
  SyntheticMotionOptions motion;
  motion.num_frames = num_frames;
  motion.amplitude_deg = 20;
  motion.period_s = 20 / motion.fps;
  SceneOptions scene;
  scene.width = 160;
  scene.height = 120;
  scene.focal_px = 200;
  scene.distance_m = 4;
  scene.lead_in = lead_in;
  return make_sequence(body, make_motion("sway", *body, motion).value(), scene).value();
}

}  // namespace silpose
