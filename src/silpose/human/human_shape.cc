#include "silpose/human/human_shape.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace silpose {
namespace {

struct Label {
  const char* name;
  double weight;
};

// Hat functions over the anchors 0, 1/2, 1.
std::array<Label, 3> three_labels(const char* low, const char* middle, const char* high, double x) {
  return {{{low, std::max(0.0, 1 - 2 * x)}, {middle, 1 - std::abs(2 * x - 1)}, {high, std::max(0.0, 2 * x - 1)}}};
}

// Calls use(target name, coefficient) for every macro target with a coefficient: the product of its labels' weights.
// Source of the rule, and of the ages from 2/3 to 1 of adults: bregier2025.
template <class Use>
void for_each_target(const Sliders& s, const Use& use) {
  const double old = std::clamp(3 * s.age - 2, 0.0, 1.0);
  const auto muscles = three_labels("minmuscle", "averagemuscle", "maxmuscle", s.muscle);
  const auto weights = three_labels("minweight", "averageweight", "maxweight", s.weight);
  for (const Label& gender : {Label{"male", 1 - s.gender}, Label{"female", s.gender}}) {
    for (const Label& age : {Label{"young", 1 - old}, Label{"old", old}}) {
      const double who_weight = gender.weight * age.weight;
      if (who_weight == 0) continue;
      const std::string who = fmt::format("{}-{}", gender.name, age.name);
      for (const char* race : {"african", "asian", "caucasian"}) use(fmt::format("{}-{}", race, who), who_weight / 3);
      for (const Label& muscle : muscles) {
        for (const Label& weight : weights) {
          const double build_weight = who_weight * muscle.weight * weight.weight;
          if (build_weight == 0) continue;
          const std::string build = fmt::format("{}-{}-{}", who, muscle.name, weight.name);
          use("universal-" + build, build_weight);
          use(build + "-minheight", build_weight * (1 - s.height));
          use(build + "-maxheight", build_weight * s.height);
          use(build + "-idealproportions", build_weight * (1 - s.proportions));
          use(build + "-uncommonproportions", build_weight * s.proportions);
        }
      }
    }
  }
}

// kg/m2. Source: adults of the world in 2014, men 24.2, women 24.4 (references.bib: ncdrisc2016).
double mean_body_mass_index(double sex) { return 24.2 + 0.2 * sex; }

// [guess] The muscle slider that goes with a weight slider. The weight slider alone changes the mass of an average
// build by a tenth only. With less muscle at both ends men's body mass index goes from 15 to 41 instead of 20 to 24.
double muscle_slider(const Phenotype& phenotype, double weight) {
  return phenotype.muscle.value_or(0.5 - std::abs(weight - 0.5));
}

// The shape is linear in the height slider, and between neighbouring anchors in the weight and muscle sliders: the
// shapes at the anchors give all others.
class ShapeGrid {
 public:
  ShapeGrid(const MakeHumanAssets& assets, const Phenotype& phenotype, Sliders sliders)
      : phenotype_(phenotype), faces_(assets.base.body_faces), blend_(kNumBodyVertices) {
    for (int m = 0; m < 2; ++m) {
      for (int w = 0; w < 3; ++w) {
        for (int h = 0; h < 2; ++h) {
          sliders.muscle = phenotype.muscle.value_or(0.5 * m);
          sliders.weight = 0.5 * w;
          sliders.height = h;
          shapes_[m][w][h] = shape_vertices(assets, sliders);
        }
      }
    }
  }
  double stature(double weight, double height) { return stature_m(blend(weight, height)); }
  double mass(double weight, double height) { return mass_kg(blend(weight, height), faces_); }

 private:
  std::span<const Eigen::Vector3f> blend(double weight, double height) {
    const int low = weight < 0.5 ? 0 : 1;
    const double upper_weight = 2 * weight - low;
    const double upper_muscle = phenotype_.muscle ? 0 : 2 * muscle_slider(phenotype_, weight);
    std::fill(blend_.begin(), blend_.end(), Eigen::Vector3f::Zero());
    for (int m = 0; m < 2; ++m) {
      for (int w = 0; w < 2; ++w) {
        for (int h = 0; h < 2; ++h) {
          const double coefficient = (m == 1 ? upper_muscle : 1 - upper_muscle) *
                                     (w == 1 ? upper_weight : 1 - upper_weight) * (h == 1 ? height : 1 - height);
          if (coefficient == 0) continue;
          const float c = static_cast<float>(coefficient);
          const std::vector<Eigen::Vector3f>& shape = shapes_[m][low + w][h];
          for (size_t v = 0; v < blend_.size(); ++v) blend_[v] += c * shape[v];
        }
      }
    }
    return blend_;
  }
  const Phenotype& phenotype_;
  std::span<const Face> faces_;
  std::vector<Eigen::Vector3f> shapes_[2][3][2];
  std::vector<Eigen::Vector3f> blend_;
};

// [guess] How exactly a wanted stature and mass are met.
constexpr double kStature_m = 1e-5, kMass_kg = 1e-3;

// The argument in [0, 1] at which a rising function takes `target`, to `tolerance` of its value.
template <class Function>
double bisect(const Function& f, double target, double tolerance) {
  double low = 0, high = 1, middle = 0.5;
  constexpr int kMostHalvings = 40;  // [guess] far more than any tolerance here needs
  for (int i = 0; i < kMostHalvings; ++i) {
    middle = (low + high) / 2;
    const double value = f(middle);
    if (std::abs(value - target) < tolerance) break;
    (value < target ? low : high) = middle;
  }
  return middle;
}

}  // namespace

double age_slider(double years) {
  // Source: bregier2025, sampling tables: adult ages in years and the slider's value.
  constexpr std::array<std::pair<double, double>, 4> kTable = {{{16, .67}, {18, .77}, {64, .83}, {110, 1}}};
  years = std::clamp(years, kTable.front().first, kTable.back().first);
  size_t i = 1;
  while (years > kTable[i].first) ++i;
  const auto& [y0, a0] = kTable[i - 1];
  const auto& [y1, a1] = kTable[i];
  return a0 + (a1 - a0) * (years - y0) / (y1 - y0);
}

double mean_height_slider(double sex) {
  // Source: bregier2025: means of the Beta distributions that fit men and women.
  return 0.391 + (0.347 - 0.391) * sex;
}

std::vector<Eigen::Vector3f> shape_vertices(const MakeHumanAssets& assets, const Sliders& sliders) {
  std::vector<Eigen::Vector3f> vertices = assets.base.vertices;
  for_each_target(sliders, [&](const std::string& name, double coefficient) {
    const MakeHumanTarget& target = assets.targets.at(name);
    const float c = static_cast<float>(coefficient);
    for (size_t i = 0; i < target.offset.size(); ++i) vertices[target.vertex_idx[i]] += c * target.offset[i];
  });
  return vertices;
}

double stature_m(std::span<const Eigen::Vector3f> vertices) {
  float lowest = vertices[0].y(), highest = vertices[0].y();
  for (size_t v = 0; v < kNumBodyVertices; ++v) {
    lowest = std::min(lowest, vertices[v].y());
    highest = std::max(highest, vertices[v].y());
  }
  return 0.1 * static_cast<double>(highest - lowest);
}

double mass_kg(std::span<const Eigen::Vector3f> vertices, std::span<const Face> body_faces) {
  double six_volumes = 0;
  for (const Face& face : body_faces) {
    const Eigen::Vector3d a = vertices[face[0]].cast<double>(), b = vertices[face[1]].cast<double>(),
                          c = vertices[face[2]].cast<double>();
    six_volumes += a.dot(b.cross(c));
  }
  constexpr double kDensity = 980;  // kg/m3. Source: bregier2025, assumed in its program
  return kDensity * six_volumes / 6 * 1e-3;
}

Result<Sliders> solve_sliders(const MakeHumanAssets& assets, const Phenotype& phenotype) {
  Sliders sliders{.gender = phenotype.sex, .age = age_slider(phenotype.age_years)};
  sliders.muscle = muscle_slider(phenotype, sliders.weight);
  sliders.height = mean_height_slider(phenotype.sex);
  ShapeGrid grid(assets, phenotype, sliders);
  if (phenotype.height_m) {
    const double lowest = grid.stature(0.5, 0), highest = grid.stature(0.5, 1);
    if (*phenotype.height_m < lowest || *phenotype.height_m > highest) {
      return error("height: {:.3f} m is out of this body's range, {:.2f} to {:.2f} m", *phenotype.height_m, lowest,
                   highest);
    }
  }
  const double average_height = sliders.height;
  const auto height_at = [&](double weight) {
    if (!phenotype.height_m) return average_height;
    return bisect([&](double height) { return grid.stature(weight, height); }, *phenotype.height_m, kStature_m);
  };
  const double lightest = grid.mass(0, height_at(0)), heaviest = grid.mass(1, height_at(1));
  if (phenotype.weight_kg && (*phenotype.weight_kg < lightest || *phenotype.weight_kg > heaviest)) {
    return error("weight: {:.1f} kg is out of this body's range, {:.1f} to {:.1f} kg", *phenotype.weight_kg, lightest,
                 heaviest);
  }
  // The sliders' average would be slender: a body mass index of 21 for men, 19 for women [measured on the shapes].
  const double height = phenotype.height_m.value_or(grid.stature(sliders.weight, average_height));
  const double weight_kg = phenotype.weight_kg.value_or(
      std::clamp(mean_body_mass_index(phenotype.sex) * height * height, lightest, heaviest));
  sliders.weight = bisect([&](double weight) { return grid.mass(weight, height_at(weight)); }, weight_kg, kMass_kg);
  sliders.muscle = muscle_slider(phenotype, sliders.weight);
  sliders.height = height_at(sliders.weight);
  return sliders;
}

}  // namespace silpose
