// Silhouettes: poses to pixel-count distances, and the distance alone.
#pragma once

#include "figure.h"

namespace silpose::bench {

Figure likelihood_full();  // the body's full mesh
Figure likelihood_lod();   // its level of detail of 2,000 vertices
Figure xor_128_us();
Figure xor_256_us();

}  // namespace silpose::bench
