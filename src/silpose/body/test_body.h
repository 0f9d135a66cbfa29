// A small body made by hand, for tests and benchmarks that should not need the fetched body data: an upright square
// tube of three bones that bends at two joints. Threads: pure.
#pragma once

#include "silpose/body/body_model.h"

namespace silpose {

// 1.5 m tall, 0.3 m wide and deep, standing on y = 0 in its rest and zero pose; closed, 68 triangles, smooth weights.
// Joints: root (y 0.5, the middle of the tube's lowest bone is fixed to it), middle (y 0.7), tip (y 1.1). 8 DOF:
// root_tx root_ty root_tz root_ry (periodic), middle_rx middle_rz, tip_rx tip_rz. End point: tip_end (y 1.5).
[[nodiscard]] BodyModel make_test_body();

}  // namespace silpose
