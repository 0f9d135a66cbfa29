#include "silpose/likelihood/end_motion.h"

namespace silpose {

LensDerivative::LensDerivative(const PinholeCamera& camera)
    : lens_(camera),
      straight_(!camera.has_distortion()),
      fx_(static_cast<float>(camera.fx)),
      fy_(static_cast<float>(camera.fy)) {
  lens_.cam_from_world = {};
}

EndMotion::EndMotion(const BodyModel& body) : skin_derivative_(body) {}

void EndMotion::fill_jacobian(const OutlineSpans& spans, std::span<const uint32_t> vertex_of_slot,
                              const LensDerivative& lens, float by, CoverageDifference& difference) {
  const SpanEnds ends = spans.ends();
  const auto cell_of_end = difference.number_cells();
  if (ends_.size() < ends.count) {
    ends_.resize(ends.count);
    slots_.resize(2 * ends.count + 1);
  }
  point_of_slot_.resize(vertex_of_slot.size(), kNone);
  uint32_t num_points = 0;
  // Without branches: whether a vertex was met before is not predictable.
  const auto point_of = [&, point_of_slot = point_of_slot_.data(), slots = slots_.data()](uint32_t slot) {
    const uint32_t known = point_of_slot[slot];
    const bool is_new = known == kNone;
    const uint32_t point = is_new ? num_points : known;
    point_of_slot[slot] = point;
    slots[num_points] = slot;
    num_points += static_cast<uint32_t>(is_new);
    return point;
  };
  size_t num_ends = 0;
  for (size_t i = 0; i < ends.count; ++i) {
    if (cell_of_end[i] < 0) continue;
    const auto cell = static_cast<size_t>(cell_of_end[i]);
    const OutlineSpans::OnEdge at = spans.edge_of(i);
    const float moves = -ends.side[i] * by * difference.confidence(cell);
    const float of_a = moves * (1 - at.t), of_b = moves * at.t;
    ends_[num_ends++] = {.cell = static_cast<uint32_t>(cell),
                         .points = {point_of(at.vertex_a), point_of(at.vertex_b)},
                         .of_x = {of_a, of_b},
                         .of_y = {-at.dx_dy * of_a, -at.dx_dy * of_b}};
  }
  vertices_.resize(num_points);
  for (size_t p = 0; p < num_points; ++p) {
    point_of_slot_[slots_[p]] = kNone;
    vertices_[p] = vertex_of_slot[slots_[p]];
  }

  skin_derivative_.set_points(vertices_);
  projections_.clear();
  for (const Eigen::Vector3f& x : skin_derivative_.positions()) projections_.push_back(lens.at(x));
  const size_t stride = skin_derivative_.row_stride();
  if (point_rows_.size() < 2 * num_points * stride) point_rows_.resize(2 * num_points * stride);
  skin_derivative_.find_rows(projections_, point_rows_.data());
  const CoverageDifference::Jacobian jacobian = difference.jacobian(stride);
  add_up_ends(ends_.data(), num_ends, {point_rows_.data(), skin_derivative_.blocks().data()}, stride,
              difference.num_end_cells(), jacobian.rows, jacobian.blocks);
}

}  // namespace silpose
