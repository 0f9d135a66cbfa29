#include "silpose/render/draw_overlay.h"

#include <opencv2/imgproc.hpp>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/render/canvas.h"

namespace silpose {
void draw_outline(ByteImage& image, const Mask& mask, Colour colour) {
  check(mask.width() == image.width() && mask.height() == image.height(),
        "draw_outline: mask of {}x{} on an image of {}x{}", mask.width(), mask.height(), image.width(), image.height());
  cv::Mat canvas = canvas_of(image);
  ByteImage bytes = image_from_mask(mask);
  const cv::Mat filled(mask.height(), mask.width(), CV_8UC1, bytes.pixels().data());
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(filled, contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  cv::polylines(canvas, contours, true, scalar_of(colour), line_width(image), cv::LINE_AA);
}

void draw_bones(ByteImage& image, const BodyModel& body, const PinholeCamera& camera, std::span<const double> pose) {
  cv::Mat canvas = canvas_of(image);
  const std::vector<Eigen::Vector3d> positions = landmark_positions(body, pose);
  const auto joints = body.skeleton.joints();
  std::vector<Colour> colours;
  for (size_t i = 0; i < positions.size(); ++i) {
    const int joint = i < joints.size() ? static_cast<int>(i) : body.end_points[i - joints.size()].joint_idx;
    colours.push_back(colour_of(side_of(body.profile, body.skeleton, joint)));
  }
  const auto parent_of = [&](size_t landmark) {
    return landmark < joints.size() ? joints[landmark].parent_idx : body.end_points[landmark - joints.size()].joint_idx;
  };
  const int width = line_width(image);
  // Dark first and wider, so that bones show on any image.
  for (const bool is_edge : {true, false}) {
    for (size_t i = 0; i < positions.size(); ++i) {
      const int parent = parent_of(i);
      if (parent < 0) continue;
      const auto from = camera.project(positions[static_cast<size_t>(parent)]), to = camera.project(positions[i]);
      if (!from || !to) continue;
      const cv::Scalar colour = is_edge ? cv::Scalar(20, 20, 20) : scalar_of(colours[i]);
      const int extra = is_edge ? 2 : 0;
      cv::line(canvas, fixed_point(*from), fixed_point(*to), colour, width + extra, cv::LINE_AA, kFractionBits);
      cv::circle(canvas, fixed_point(*to), (2 * width + extra) << (kFractionBits - 1), colour, cv::FILLED, cv::LINE_AA,
                 kFractionBits);
    }
  }
}

}  // namespace silpose
