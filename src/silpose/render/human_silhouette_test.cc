#include <gtest/gtest.h>

#include <filesystem>

#include "silpose/base/rng.h"
#include "silpose/base/simd_targets.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

// The human of the set-up, in poses that use two thirds of every angle's range.
class HumanSilhouetteTest : public testing::Test {
 protected:
  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(
      level_of_detail(load_body(std::filesystem::path(SILPOSE_DATA_DIR) / "human.body").value(), 2000));
  PinholeCamera camera_ = default_camera(640, 480);

  std::vector<double> random_pose(Rng& rng) const {
    std::vector<double> pose = standing_pose(*body_);
    const auto dofs = body_->skeleton.dofs();
    for (size_t d = 0; d < pose.size(); ++d) {
      const double range = dofs[d].is_translation ? 1.0 : (dofs[d].upper - dofs[d].lower) * 2 / 3;
      pose[d] += range * rng.uniform(-0.5, 0.5);
    }
    return pose;
  }
};

TEST_F(HumanSilhouetteTest, BothRenderersAgreeToThePixel) {
  const EdgeTopology topology(body_->rest.faces);
  OutlineRenderer renderer(topology);
  Mask fast, reference;
  Rng rng(21);
  for (int i = 0; i < 60; ++i) {
    const auto vertices = skin_vertices(*body_, random_pose(rng));
    std::vector<Eigen::Vector2f> pixels(vertices.size());
    project_vertices(camera_, vertices, pixels);
    for (const Window& window :
         {Window{.width = 640, .height = 480},
          Window{.x0 = 200, .y0 = 140, .scale_x = 0.47, .scale_y = 0.41, .width = 128, .height = 128}}) {
      draw_silhouette_reference(pixels, body_->rest.faces, window, reference);
      ASSERT_GT(reference.count(), 300);
      for_each_simd_target([&](const char* name) {
        renderer.draw(pixels, window, fast);
        ASSERT_EQ(fast, reference) << name;
      });
    }
  }
}

TEST_F(HumanSilhouetteTest, BatchCountsWhatTheReferenceDraws) {
  Rng rng(22);
  const size_t num_poses = 100, num_dofs = static_cast<size_t>(body_->skeleton.num_dofs());
  std::vector<double> poses;
  for (size_t n = 0; n < num_poses; ++n) {
    const auto pose = random_pose(rng);
    poses.insert(poses.end(), pose.begin(), pose.end());
  }
  const Mask observed = render_silhouette(*body_, camera_, std::span(poses).first(num_dofs));
  std::vector<OutlineRenderer::Counts> counts(num_poses);
  const Window whole{.width = 640, .height = 480};
  std::vector<Mask> masks;
  for (size_t n = 0; n < num_poses; ++n) {
    masks.push_back(render_silhouette(*body_, camera_, std::span(poses).subspan(n * num_dofs, num_dofs)));
  }
  for_each_simd_target([&](const char* name) {
    BatchRenderer(body_, camera_).counts({poses.data(), num_poses, num_dofs, num_dofs}, whole, observed, counts);
    EXPECT_NEAR(static_cast<double>(counts[0].both), static_cast<double>(observed.count()), 6);
    for (size_t n = 0; n < num_poses; ++n) {
      EXPECT_NEAR(static_cast<double>(counts[n].model), static_cast<double>(masks[n].count()), 6) << name << n;
      EXPECT_NEAR(static_cast<double>(counts[n].both), static_cast<double>(and_count(masks[n], observed)), 6) << n;
    }
  });
}

}  // namespace
}  // namespace silpose
