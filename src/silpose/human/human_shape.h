// From a phenotype to a shape: MakeHuman's macro sliders, the blend of its targets, and the search for the sliders that
// give a wanted stature and mass. Private to the module `body`.
// Based on: the target rule and the age, height tables of Anny (references.bib: bregier2025); data: makehuman.
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/human/human.h"
#include "silpose/human/makehuman_assets.h"

namespace silpose {

// All 0 to 1; age from 2/3 (young adult) to 1 (old). Races are mixed equally.
struct Sliders {
  double gender = 0.5;  // 0 male, 1 female
  double age = 2.0 / 3;
  double muscle = 0.5;
  double weight = 0.5;
  double height = 0.5;
  double proportions = 0.5;  // 0 ideal, 1 uncommon
};

// Age slider for an age in years; the mean of the height slider over people of a sex.
[[nodiscard]] double age_slider(double years);
[[nodiscard]] double mean_height_slider(double sex);

// Every vertex [19158] of the shape, file units (decimetres).
[[nodiscard]] std::vector<Eigen::Vector3f> shape_vertices(const MakeHumanAssets& assets, const Sliders& sliders);

// Metres and kilograms of a shape: extent of the body along Y; volume x 980 kg/m3.
[[nodiscard]] double stature_m(std::span<const Eigen::Vector3f> vertices);
[[nodiscard]] double mass_kg(std::span<const Eigen::Vector3f> vertices, std::span<const Face> body_faces);

// The sliders that give the phenotype. Errors: stature or mass out of reach, naming the range.
Result<Sliders> solve_sliders(const MakeHumanAssets& assets, const Phenotype& phenotype);

}  // namespace silpose
