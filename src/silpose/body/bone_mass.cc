#include "silpose/body/bone_mass.h"

#include <algorithm>
#include <cmath>

namespace silpose {
namespace {

constexpr int kColumns = 200;  // along the body's greatest extent

// Where a column crosses the skin.
struct Crossing {
  float z = 0;
  int joint_idx = 0;
};

// [V] the bone that has most of each vertex.
std::vector<int> joint_of_vertices(const BodyModel& body) {
  std::vector<int> joints;
  for (size_t v = 0; v < body.rest.vertices.size(); ++v) {
    const auto begin = body.skin.weight.begin() + body.skin.row_start[v];
    const auto most = std::max_element(begin, body.skin.weight.begin() + body.skin.row_start[v + 1]);
    joints.push_back(body.skin.joint_idx[static_cast<size_t>(most - body.skin.weight.begin())]);
  }
  return joints;
}

}  // namespace

std::vector<BoneMass> bone_masses(const BodyModel& body) {
  const std::vector<Eigen::Vector3f>& vertices = body.rest.vertices;
  Eigen::Vector3f lowest = vertices.front(), highest = vertices.front();
  for (const Eigen::Vector3f& x : vertices) lowest = lowest.cwiseMin(x), highest = highest.cwiseMax(x);
  const float side = (highest - lowest).maxCoeff() / kColumns;
  const int width = static_cast<int>((highest.x() - lowest.x()) / side) + 1;
  const int height = static_cast<int>((highest.y() - lowest.y()) / side) + 1;

  const std::vector<int> joint_of = joint_of_vertices(body);
  std::vector<std::vector<Crossing>> columns(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (const Face& face : body.rest.faces) {
    const Eigen::Vector3f &a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (area == 0) continue;
    const auto column = [&](float x, float from) { return static_cast<int>(std::floor((x - from) / side)); };
    const auto [left, right] = std::minmax({a.x(), b.x(), c.x()});
    const auto [bottom, top] = std::minmax({a.y(), b.y(), c.y()});
    for (int row = column(bottom, lowest.y()); row <= std::min(column(top, lowest.y()), height - 1); ++row) {
      for (int col = column(left, lowest.x()); col <= std::min(column(right, lowest.x()), width - 1); ++col) {
        // Off the middle, where no edge of a symmetric mesh lies.
        const float x = lowest.x() + (static_cast<float>(col) + 0.4931f) * side;
        const float y = lowest.y() + (static_cast<float>(row) + 0.5077f) * side;
        const float of_b = ((x - a.x()) * (c.y() - a.y()) - (y - a.y()) * (c.x() - a.x())) / area;
        const float of_c = ((b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x())) / area;
        if (of_b < 0 || of_c < 0 || of_b + of_c > 1) continue;
        const size_t nearest = of_b > 0.5f ? 1 : of_c > 0.5f ? 2 : 0;
        columns[static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(col)].push_back(
            {a.z() + of_b * (b.z() - a.z()) + of_c * (c.z() - a.z()), joint_of[face[nearest]]});
      }
    }
  }

  const size_t J = body.skeleton.joints().size();
  std::vector<double> mass(J, 0);
  std::vector<Eigen::Vector3d> moment(J, Eigen::Vector3d::Zero());
  for (size_t i = 0; i < columns.size(); ++i) {
    std::vector<Crossing>& crossings = columns[i];
    std::ranges::sort(crossings, {}, &Crossing::z);
    const size_t row = i / static_cast<size_t>(width), col = i % static_cast<size_t>(width);
    const double x = lowest.x() + (static_cast<double>(col) + 0.4931) * side;
    const double y = lowest.y() + (static_cast<double>(row) + 0.5077) * side;
    for (size_t k = 0; k + 1 < crossings.size(); k += 2) {
      const double half = (crossings[k + 1].z - crossings[k].z) / 2;
      for (const auto& [joint_idx, z] : {std::pair(crossings[k].joint_idx, crossings[k].z + half / 2),
                                         std::pair(crossings[k + 1].joint_idx, crossings[k + 1].z - half / 2)}) {
        mass[static_cast<size_t>(joint_idx)] += half;
        moment[static_cast<size_t>(joint_idx)] += half * Eigen::Vector3d(x, y, z);
      }
    }
  }
  double whole = 0;
  for (const double one : mass) whole += one;
  std::vector<BoneMass> masses;
  for (size_t j = 0; j < J; ++j) {
    if (mass[j] == 0) continue;
    masses.push_back({static_cast<int>(j), body.joint_from_rest[j] * (moment[j] / mass[j]), mass[j] / whole});
  }
  return masses;
}

}  // namespace silpose
