// Backdrops of synthetic video: what an empty room, or a green studio, looks like from a camera.
// Textures are value noise (grid values, smoothly interpolated) on the floor y = 0 and on a wall behind the scene; the
// same seed gives the same room from every camera that faces the same way. Threads: functions without state.
#pragma once

#include <cstdint>
#include <string>

#include "silpose/base/result.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/image.h"

namespace silpose {

enum class Backdrop { kTextured, kGreen };

// "textured" or "green". Errors: anything else.
Result<Backdrop> parse_backdrop(const std::string& text);

// The image [H, W, 3] of the empty place. The wall stands upright `wall_distance_m` in front of the camera.
ByteImage draw_backdrop(const PinholeCamera& camera, Backdrop backdrop, double wall_distance_m, uint64_t seed);

}  // namespace silpose
