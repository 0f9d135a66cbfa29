#include "silpose/render/draw_floor.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "silpose/base/check.h"
#include "silpose/render/canvas.h"
#include "silpose/render/segment_projector.h"

namespace silpose {
namespace {

constexpr int kReach = 3;                  // metres of grid on each side
constexpr double kStrength = 0.6;          // of what is drawn against the image below it
constexpr double kEdgeStrength = 0.25;     // the same of the grid's dark edges
constexpr double kTouching = 0.02;         // metres
constexpr Colour kGrid = {235, 235, 235};  // on kEdge, so that it shows on any floor
constexpr Colour kEdge = {20, 20, 20};

void draw_line(cv::Mat& canvas, const std::vector<Eigen::Vector2d>& pixels, Colour colour, int width) {
  if (pixels.size() < 2) return;
  std::vector<cv::Point> points;
  points.reserve(pixels.size());
  for (const Eigen::Vector2d& pixel : pixels) points.push_back(fixed_point(pixel));
  cv::polylines(canvas, points, false, scalar_of(colour), width, cv::LINE_AA, kFractionBits);
}

// For each joint the foot it belongs to: the outermost contact joint among its ancestors and itself; -1: none.
std::vector<int> foot_of_joints(const BodyModel& body) {
  std::vector<int> foot_of;
  for (const Joint& joint : body.skeleton.joints()) {
    const int j = static_cast<int>(foot_of.size());
    const int above = joint.parent_idx < 0 ? -1 : foot_of[static_cast<size_t>(joint.parent_idx)];
    const bool is_foot = std::ranges::count(body.profile.contact_joints, j) > 0;
    foot_of.push_back(above >= 0 ? above : is_foot ? j : -1);
  }
  return foot_of;
}

Eigen::Vector3d on_floor(const Eigen::Vector2d& xz) { return {xz.x(), 0, xz.y()}; }

}  // namespace

void draw_floor(ByteImage& image, const PinholeCamera& camera, const Eigen::Vector2d& middle, const Mask& in_front) {
  check(camera.width == image.width() && camera.height == image.height(), "draw_floor: camera of {}x{}, image {}x{}",
        camera.width, camera.height, image.width(), image.height());
  ByteImage drawn = image;
  cv::Mat below = canvas_of(image), canvas = canvas_of(drawn);
  const SegmentProjector project(camera);
  const int width = std::max(1, line_width(image) / 2);
  const double x = std::round(middle.x()), z = std::round(middle.y());
  const auto draw_grid = [&](Colour colour, int line, double strength) {
    const cv::Mat before = canvas.clone();
    for (int i = -kReach; i <= kReach; ++i) {
      draw_line(canvas, project({x + i, 0, z - kReach}, {x + i, 0, z + kReach}), colour, line);
      draw_line(canvas, project({x - kReach, 0, z + i}, {x + kReach, 0, z + i}), colour, line);
    }
    cv::addWeighted(canvas, strength, before, 1 - strength, 0, canvas);
  };
  draw_grid(kEdge, width + 2, kEdgeStrength);
  draw_grid(kGrid, width, kStrength);
  for (int axis = 0; axis < 3; ++axis) {
    Colour colour = {40, 40, 40};
    colour[static_cast<size_t>(2 - axis)] = 255;  // B, G, R
    draw_line(canvas, project(Eigen::Vector3d::Zero(), Eigen::Vector3d::Unit(axis)), colour, 2 * line_width(image));
  }
  if (in_front.width() > 0) {
    const ByteImage covered = image_from_mask(in_front);
    below.copyTo(canvas,
                 cv::Mat(covered.height(), covered.width(), CV_8UC1, const_cast<uint8_t*>(covered.pixels().data())));
  }
  image = std::move(drawn);
}

std::vector<Footprint> footprints(const BodyModel& body, std::span<const double> pose) {
  const std::vector<int> foot_of = foot_of_joints(body);
  const std::vector<Eigen::Vector3f> vertices = skin_vertices(body, pose);
  const std::vector<int> main_joint = main_joints(body);
  std::vector<std::vector<Eigen::Vector3f>> points(foot_of.size());  // by foot
  for (size_t v = 0; v < vertices.size(); ++v) {
    const int foot = foot_of[static_cast<size_t>(main_joint[v])];
    if (foot >= 0) points[static_cast<size_t>(foot)].push_back(vertices[v]);
  }
  std::vector<Footprint> result;
  for (size_t foot = 0; foot < points.size(); ++foot) {
    if (points[foot].size() < 3) continue;
    Footprint print{.joint_idx = static_cast<int>(foot)};
    std::vector<cv::Point2f> floor_points, hull;
    for (const Eigen::Vector3f& point : points[foot]) floor_points.emplace_back(point.x(), point.z());
    cv::convexHull(floor_points, hull);
    for (const cv::Point2f& point : hull) print.outline.emplace_back(point.x, point.y);
    print.lowest = std::min_element(points[foot].begin(), points[foot].end(), [](const auto& a, const auto& b) {
                     return a.y() < b.y();
                   })->cast<double>();
    result.push_back(std::move(print));
  }
  return result;
}

void draw_footprints(ByteImage& image, const BodyModel& body, const PinholeCamera& camera,
                     std::span<const double> pose) {
  cv::Mat canvas = canvas_of(image);
  const SegmentProjector project(camera);
  const int width = line_width(image);
  for (const Footprint& print : footprints(body, pose)) {
    const Colour colour = colour_of(side_of(body.profile, body.skeleton, print.joint_idx));
    const size_t corners = print.outline.size();
    std::vector<cv::Point> area;
    for (size_t i = 0; i < corners; ++i) {
      for (const Eigen::Vector2d& pixel :
           project(on_floor(print.outline[i]), on_floor(print.outline[(i + 1) % corners]))) {
        area.push_back(fixed_point(pixel));
      }
    }
    if (area.empty()) continue;
    if (std::abs(print.lowest.y()) <= kTouching) {
      cv::Mat filled = canvas.clone();
      cv::fillPoly(filled, area, scalar_of(colour), cv::LINE_AA, kFractionBits);
      cv::addWeighted(filled, kStrength, canvas, 1 - kStrength, 0, canvas);
    }
    const std::vector<Eigen::Vector2d> drop = project(print.lowest, {print.lowest.x(), 0, print.lowest.z()});
    for (const auto& [shade, extra] : {std::pair(kEdge, 2), std::pair(colour, 0)}) {
      cv::polylines(canvas, area, true, scalar_of(shade), width + extra, cv::LINE_AA, kFractionBits);
      draw_line(canvas, drop, shade, width + extra);
    }
  }
}

}  // namespace silpose
