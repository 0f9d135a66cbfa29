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
  derivative.set_pose(pose, body.skeleton.forward_kinematics(pose), frame);
  const auto vertices = skin_vertices(body, pose);
  const Eigen::Vector3f g(0.3f, -1.0f, 0.6f), h(-2.0f, 0.5f, 0.1f);
  const uint32_t v = 5, w = static_cast<uint32_t>(vertices.size()) - 3;
  for (int twice = 0; twice < 2; ++twice) {
    derivative.set_points(std::vector{w, v});
    const Eigen::Vector3f expected = turn * vertices[v] + frame.translation.cast<float>();
    EXPECT_LT((derivative.positions()[1] - expected).norm(), 1e-6);
    AlignedFloats rows;
    rows.resize(4 * derivative.row_stride());
    Eigen::Matrix<float, 2, 3> one, other;
    one << (turn * h).transpose(), (turn * g).transpose();
    other << (turn * g).transpose(), (turn * h).transpose();
    derivative.find_rows(std::vector{one, other}, rows.data());
    const auto row = [&](size_t i) { return rows.data() + i * derivative.row_stride(); };
    for (size_t d = 0; d < pose.size(); ++d) {
      const double step = 1e-3;
      std::vector<double> more = pose, less = pose;
      more[d] += step;
      less[d] -= step;
      const auto x = skin_vertices(body, more), y = skin_vertices(body, less);
      EXPECT_NEAR(row(0)[derivative.columns()[d]], h.dot(x[w] - y[w]) / (2 * step), 2e-3) << d;
      EXPECT_NEAR(row(1)[derivative.columns()[d]], g.dot(x[w] - y[w]) / (2 * step), 2e-3) << d;
      EXPECT_NEAR(row(2)[derivative.columns()[d]], g.dot(x[v] - y[v]) / (2 * step), 2e-3) << d;
      EXPECT_NEAR(row(3)[derivative.columns()[d]], h.dot(x[v] - y[v]) / (2 * step), 2e-3) << d;
    }
  }
}

}  // namespace
}  // namespace silpose
