// Colour of what is drawn on an image. A value.
#pragma once

#include <array>
#include <cstdint>

namespace silpose {

using Colour = std::array<uint8_t, 3>;  // B, G, R

}  // namespace silpose
