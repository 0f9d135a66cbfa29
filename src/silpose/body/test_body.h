// A small body made by hand, for tests and benchmarks that should not need the fetched body data: an upright square
// tube of three bones that bends at two joints. Threads: pure.
#pragma once

#include "silpose/body/body_model.h"

namespace silpose {

// 1.5 m tall, 0.3 m wide and deep, standing on y = 0 in its rest and zero pose; closed, 68 triangles, smooth weights.
// Joints: root (y 0.5, the middle of the tube's lowest bone is fixed to it), middle (y 0.7), tip (y 1.1). 8 DOF:
// root_tx root_ty root_tz root_ry (periodic), middle_rx middle_rz, tip_rx tip_rz. End point: tip_end (y 1.5).
[[nodiscard]] BodyModel make_test_body();

// Two balls of radius 0.2 m side by side on the floor, 1 m apart in the zero pose, which is also the rest pose; 224
// facets each. Joints, in the middle of a ball each: root (x 0, y 0.2), tip (x 1, y 0.2). 3 DOF: root_ty, root_rz,
// tip_tx.
[[nodiscard]] BodyModel make_ball_body();

}  // namespace silpose
