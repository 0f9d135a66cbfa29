// Draws a batch of poses: batch_silhouettes BODY.body COUNT SEED. Random poses within the limits, in front of a camera
// of 640 x 480 pixels; prints how many pixels each covers, and how many of these the first one covers, too.
#include <fmt/format.h>
#include <silpose/body/random_pose.h>
#include <silpose/render/render_backend.h>
#include <silpose/silpose.h>

#include <cstdlib>
#include <exception>
#include <memory>
#include <stdexcept>
#include <vector>

int main(int argc, char** argv) try {
  if (argc != 4 || std::atoi(argv[2]) < 1) {
    fmt::print(stderr, "usage: batch_silhouettes BODY.body COUNT SEED\n");
    return 2;
  }
  const auto body = std::make_shared<silpose::BodyModel>(silpose::load_body(argv[1]).value());
  const silpose::PinholeCamera camera = silpose::default_camera(640, 480);
  const auto count = static_cast<size_t>(std::atoi(argv[2]));
  const auto num_dofs = static_cast<size_t>(body->skeleton.num_dofs());
  silpose::Rng rng(std::strtoull(argv[3], nullptr, 10));
  const std::vector<double> standing(num_dofs, 0.0);
  std::vector<double> poses;  // [N, D]
  for (size_t n = 0; n < count; ++n) {
    const std::vector<double> pose = silpose::random_pose(body->skeleton, standing, rng, {.part = 0.5});
    poses.insert(poses.end(), pose.begin(), pose.end());
  }

  const auto backend = silpose::make_cpu_backend(body, camera);
  const silpose::BatchView batch{poses.data(), count, num_dofs, num_dofs};
  const silpose::Framing image{{.width = camera.width, .height = camera.height}};
  std::vector<silpose::Mask> masks(count);
  backend->silhouettes(batch, image, masks);
  // Where only areas matter nothing has to be kept of the drawings, which is several times faster.
  std::vector<silpose::OutlineRenderer::Counts> counts(count);
  if (!backend->counts(batch, image, masks.front(), counts)) throw std::runtime_error("this backend does not count");
  for (size_t n = 0; n < count; ++n) fmt::print("{} {} {}\n", n, masks[n].count(), counts[n].both);
} catch (const std::exception& failure) {
  fmt::print(stderr, "batch_silhouettes: {}\n", failure.what());
  return 1;
}
