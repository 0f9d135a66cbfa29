#include "silpose/synth/scene.h"

#include <charconv>
#include <cmath>
#include <set>

#include "silpose/base/check.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

constexpr double kFarthest = 200, kBackOff = 1.05;  // m, factor per try
constexpr double kMargin = 0.01;                    // of the image's size, free on every side

struct Bounds {
  Eigen::Vector3d lower = Eigen::Vector3d::Constant(1e9), upper = Eigen::Vector3d::Constant(-1e9);
};

// The points of the mesh that matter for framing, of every pose.
std::vector<std::vector<Eigen::Vector3f>> posed_vertices(const BodyModel& body,
                                                         const std::vector<std::vector<double>>& poses) {
  std::vector<std::vector<Eigen::Vector3f>> all;
  const std::vector<double>* last = nullptr;
  for (const std::vector<double>& pose : poses) {
    if (last != nullptr && *last == pose) continue;  // static: once is enough
    all.push_back(skin_vertices(body, pose));
    last = &pose;
  }
  return all;
}

bool is_inside(const PinholeCamera& camera, const std::vector<Eigen::Vector3f>& vertices) {
  const double margin_x = kMargin * camera.width, margin_y = kMargin * camera.height;
  for (const Eigen::Vector3f& vertex : vertices) {
    const auto pixel = camera.project(vertex.cast<double>());
    if (!pixel || pixel->x() < margin_x || pixel->y() < margin_y || pixel->x() > camera.width - margin_x ||
        pixel->y() > camera.height - margin_y) {
      return false;
    }
  }
  return true;
}

}  // namespace

Result<View> parse_view(const std::string& text) {
  if (text == "front") return View{text, 0};
  if (text == "side") return View{text, 90};
  double degrees = 0;
  const char* last = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), last, degrees);
  if (text.empty() || parsed.ec != std::errc() || parsed.ptr != last || !std::isfinite(degrees)) {
    return error("view '{}': front, side or degrees", text);
  }
  return View{text, degrees};
}

Result<SyntheticSequence> make_sequence(std::shared_ptr<const BodyModel> body, const SyntheticMotion& motion,
                                        const SceneOptions& options) {
  check(body != nullptr, "make_sequence: no body");
  check(options.width > 0 && options.height > 0 && options.focal_px > 0 && options.distance_m > 0,
        "make_sequence: image {}x{}, focal length {} px, distance {} m", options.width, options.height,
        options.focal_px, options.distance_m);
  check(options.lead_in >= 0, "make_sequence: lead-in of {} frames", options.lead_in);
  check(!options.views.empty(), "make_sequence: no view");
  std::set<std::string> names;
  for (const View& view : options.views) {
    check(names.insert(view.name).second, "make_sequence: two views named {}", view.name);
  }
  if (motion.poses.empty()) return error("the motion has no frame");

  const auto vertices = posed_vertices(*body, motion.poses);
  Bounds bounds;
  for (const auto& frame : vertices) {
    for (const Eigen::Vector3f& vertex : frame) {
      bounds.lower = bounds.lower.cwiseMin(vertex.cast<double>());
      bounds.upper = bounds.upper.cwiseMax(vertex.cast<double>());
    }
  }
  const Eigen::Vector3d middle = (bounds.lower + bounds.upper) / 2;

  SyntheticSequence sequence;
  sequence.body = std::move(body);
  sequence.poses = motion.poses;
  sequence.fps = motion.fps;
  sequence.lead_in = options.lead_in;
  for (double distance = options.distance_m; distance <= kFarthest; distance *= kBackOff) {
    sequence.distance_m = distance;
    sequence.cameras.clear();
    bool all_inside = true;
    for (const View& view : options.views) {
      const double azimuth = to_radians(view.azimuth_deg);
      const Eigen::Vector3d camera_centre =
          middle + distance * Eigen::Vector3d(std::sin(azimuth), 0, std::cos(azimuth));
      PinholeCamera camera = look_at_camera(options.width, options.height, options.focal_px, camera_centre, middle);
      camera.name = view.name;
      for (const auto& frame : vertices) all_inside = all_inside && is_inside(camera, frame);
      sequence.cameras.push_back(std::move(camera));
    }
    if (all_inside) return sequence;
  }
  return error("the motion does not fit into an image of {}x{} pixels, focal length {} px, from {} m away",
               options.width, options.height, options.focal_px, kFarthest);
}

std::span<const double> pose_of_frame(const SyntheticSequence& sequence, int frame) {
  check(frame >= 0 && frame < sequence.num_frames(), "pose_of_frame: frame {} of {}", frame, sequence.num_frames());
  if (frame < sequence.lead_in) return {};
  return sequence.poses[static_cast<size_t>(frame - sequence.lead_in)];
}

Mask true_mask(const SyntheticSequence& sequence, int camera_idx, int frame) {
  const PinholeCamera& camera = sequence.cameras.at(static_cast<size_t>(camera_idx));
  const std::span<const double> pose = pose_of_frame(sequence, frame);
  if (pose.empty()) return Mask(camera.width, camera.height);
  return render_silhouette(*sequence.body, camera, pose);
}

}  // namespace silpose
