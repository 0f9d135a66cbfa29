// A tiny ready-made scene for tests of other modules: milliseconds to make, no fetched body data needed.
// Threads: pure.
#pragma once

#include "silpose/synth/scene.h"

namespace silpose {

// The test body (body/test_body.h) swaying in front of one camera that looks at its front; 160x120 pixels, 30 fps.
// With num_frames 20 its middle bends by up to 20 degrees. Masks are about 23x75 pixels.
[[nodiscard]] SyntheticSequence make_test_scene(int num_frames = 20, int lead_in = 0);

}  // namespace silpose
