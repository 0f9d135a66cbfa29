#include "silpose/body/skin_derivative.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/body/test_body.h"

namespace silpose {
namespace {

TEST(SkinDerivative, AgreesWithFiniteDifferencesOfSkinning) {
  const BodyModel body = make_test_body();
  std::vector<double> pose = standing_pose(body);
  for (size_t d = 0; d < pose.size(); ++d) pose[d] += 0.3 * std::sin(static_cast<double>(d) + 1);
  SkinDerivative derivative(body);
  const Rigid3 frame = {Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(), {1, -2, 5}};
  const Eigen::Matrix3f turn = frame.rotation.cast<float>();
  derivative.set_pose(pose, frame);
  const auto vertices = skin_vertices(body, pose);
  const Eigen::Vector3f g(0.3f, -1.0f, 0.6f), h(-2.0f, 0.5f, 0.1f);
  const uint32_t v = 5, w = static_cast<uint32_t>(vertices.size()) - 3;
  EXPECT_LT((derivative.position(v) - (turn * vertices[v] + frame.translation.cast<float>())).norm(), 1e-6);
  for (int twice = 0; twice < 2; ++twice) {  // taking forgets
    derivative.add(w, turn * g);
    derivative.end_sum();
    derivative.end_sum();  // of nothing
    derivative.add(v, turn * g);
    derivative.add(w, turn * h);
    derivative.end_sum();
    ASSERT_EQ(derivative.num_sums(), 3);
    AlignedFloats rows;
    rows.resize(3 * derivative.row_stride());
    derivative.take(rows.data());
    for (size_t d = 0; d < derivative.row_stride(); ++d) EXPECT_EQ(rows.data()[derivative.row_stride() + d], 0) << d;
    const float* const row = rows.data() + 2 * derivative.row_stride();
    EXPECT_EQ(row[pose.size()], 0);
    for (size_t d = 0; d < pose.size(); ++d) {
      const double step = 1e-3;
      std::vector<double> more = pose, less = pose;
      more[d] += step;
      less[d] -= step;
      const auto x = skin_vertices(body, more), y = skin_vertices(body, less);
      EXPECT_NEAR(row[d], (g.dot(x[v] - y[v]) + h.dot(x[w] - y[w])) / (2 * step), 2e-3) << d;
    }
  }
}

}  // namespace
}  // namespace silpose
