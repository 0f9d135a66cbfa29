// Depth images and shaded images of a mesh; for viewing and for synthetic video, never for tracking. Depth-buffered
// triangles, exactly those that silhouette.h draws; smooth Lambert shading by vertex; a shadow on the floor y = 0;
// edges smoothed by 2x2 samples per pixel.
// Threads: pure functions.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/geometry/mesh.h"
#include "silpose/image/image.h"
#include "silpose/shape/window.h"

namespace silpose {

// Distance along the camera's axis in metres at each pixel's centre; 0 where there is no surface. Where it is not 0 is
// the silhouette.
[[nodiscard]] Image<float> draw_depth(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
                                      std::span<const Face> faces);
// The same in a window of the image.
[[nodiscard]] Image<float> draw_depth(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
                                      std::span<const Face> faces, const Window& window);

struct Lighting {
  Eigen::Vector3d to_light = {0.4, 1.0, 0.7};  // world, of any length; the light is far away
  double ambient = 0.45;                       // brightness of what is turned away from the light, 0 to 1
  double shadow = 0;                           // how much of its brightness the floor loses in the shadow, 0 to 1
};

// Draws a mesh over what `image` (3 channels, the camera's size) shows already. `colours` [V] are B, G, R in 0 to 1.
// The shadow falls on the floor and is seen wherever the floor would be: the image has no other surfaces.
void draw_shaded(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
                 std::span<const Face> faces, std::span<const Eigen::Vector3f> colours, const Lighting& lighting,
                 ByteImage& image);

// Skin, hair, shirt, trousers and shoes by joint, [V] for draw_shaded(); one colour for bodies that are not human.
[[nodiscard]] std::vector<Eigen::Vector3f> clothing_colours(const BodyModel& body);

}  // namespace silpose
