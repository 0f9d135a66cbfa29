// What silpose_bench measures, one function per figure: each checks its result, then times it next to its peers in the
// given number of rounds. Errors: throw std::runtime_error for a wrong result or missing data.
#pragma once

#include "figure.h"

namespace silpose::bench {

// Poses to pixel-count distances, 128x128: the body's full mesh, and its level of detail of 2,000 vertices.
Figure likelihood_full(int rounds);
Figure likelihood_lod(int rounds);
// The full mesh by coverage in place of pixels.
Figure likelihood_coverage(int rounds);
// Depth images of the full mesh, 128x128, to their distances from an observed one.
Figure depth_full(int rounds);
// likelihood_full on two threads against one: the median of the rounds' ratios.
Figure scaling_2_threads(int rounds);

// XOR count of two masks.
Figure xor_128_us(int rounds);
Figure xor_256_us(int rounds);

// 361x361 poses of a two-bone tube, one frame's observation.
Figure metric_surface_s(int rounds);

// One Gauss-Newton step of the fit at sigma 4: energy, Jacobian, normal equations; of the level of detail of 2,500
// vertices that the tracker fits, and of the full mesh. The energy alone, 2,500 vertices.
Figure fit_step_us(int rounds);
Figure fit_step_full_us(int rounds);
Figure fit_energy_us(int rounds);

// `silpose track` of a synthetic 640x480 colour clip, start-up included: its preset, and 1,000 particles in one layer.
Figure track_vga_fps(int rounds);
Figure track_vga_particles_fps(int rounds);

}  // namespace silpose::bench
