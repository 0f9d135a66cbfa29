#include "silpose/render/view_volume.h"

namespace silpose {

ViewVolume::ViewVolume(const PinholeCamera& camera, double margin) {
  constexpr int kRaysPerSide = 16;  // where the view's bounds are looked for
  Eigen::Array2d least = Eigen::Array2d::Zero(), most = Eigen::Array2d::Zero();
  const auto include = [&](double u, double v) {
    const Eigen::Array2d slope = camera.ray_from_pixel({u, v}).head<2>().array();
    least = least.min(slope);
    most = most.max(slope);
  };
  for (int i = 0; i <= kRaysPerSide; ++i) {
    const double u = camera.width * (i / double(kRaysPerSide)), v = camera.height * (i / double(kRaysPerSide));
    include(u, 0);
    include(u, camera.height);
    include(0, v);
    include(camera.width, v);
  }
  const Eigen::Array2d room = margin * (most - least);
  least -= room;
  most += room;
  half_spaces = {{{0, 0, 1, -PinholeCamera::kNear},
                  {1, 0, -least.x(), 0},
                  {-1, 0, most.x(), 0},
                  {0, 1, -least.y(), 0},
                  {0, -1, most.y(), 0}}};
}

}  // namespace silpose
