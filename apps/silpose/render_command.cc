// silpose render: one pose as an image.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>

#include "apps/silpose/command.h"
#include "apps/silpose/shared_options.h"
#include "silpose/base/option_error.h"
#include "silpose/base/whole_file.h"
#include "silpose/exchange/tables.h"
#include "silpose/image/image_file.h"
#include "silpose/render/draw_floor.h"
#include "silpose/render/shaded.h"
#include "silpose/render/silhouette.h"
#include "silpose/session/body_choice.h"
#include "silpose/session/camera_choice.h"
#include "silpose/synth/scene.h"

namespace silpose::app {
namespace {

struct RenderOptions {
  std::string pose, out, kind = "silhouette", model = "human", size = "640x480", view;
  CameraOptions camera;
  bool draw_floor = false;
};

// FILE.csv or FILE.csv:ROW; rows count from 0.
Result<std::vector<double>> read_row(const std::string& text, const Skeleton& skeleton) {
  std::string file = text;
  size_t row = 0;
  const size_t colon = text.rfind(':');
  if (colon != std::string::npos && !std::filesystem::exists(text)) {
    const char* const end = text.data() + text.size();
    const auto [rest, bad] = std::from_chars(text.data() + colon + 1, end, row);
    if (bad != std::errc() || rest != end) {
      throw_option_error("--pose {}: {} is not a row", text, text.substr(colon + 1));
    }
    file = text.substr(0, colon);
  }
  const Result<PoseTable> table = read_poses(file, skeleton);
  if (!table) return table.failure();
  if (row >= table->rows.size()) return error("{}: there is no row {} ({} rows)", text, row, table->rows.size());
  return table->rows[row].values;
}

// A camera that sees the whole pose from a side, or the one of a file.
Result<PinholeCamera> choose_camera(const RenderOptions& options, const std::shared_ptr<const BodyModel>& body,
                                    const std::vector<double>& pose) {
  if (!options.camera.file.empty()) {
    if (!options.view.empty()) throw_option_error("--view: not together with --camera");
    const Result<CameraChoice> choice = choose_cameras(options.camera, {});
    if (!choice) return choice.failure();
    return choice->cameras.front();
  }
  const Size size = parse_size("--size", options.size);
  const Result<View> view = parse_view(options.view.empty() ? "front" : options.view);
  if (!view) throw_option_error("--view: {}", view.error().message);
  SceneOptions scene;
  scene.width = size.width;
  scene.height = size.height;
  scene.focal_px *= std::min(size.width / 640.0, size.height / 480.0);
  scene.views = {*view};
  SyntheticMotion motion;
  motion.poses = {pose};
  const Result<SyntheticSequence> sequence = make_sequence(body, motion, scene);
  if (!sequence) return sequence.failure();
  return sequence->cameras.front();
}

// 16-bit, millimetres; 0 where there is nothing.
Result<void> write_depth(const std::filesystem::path& path, const Image<float>& depth) {
  DepthImage millimetres(depth.width(), depth.height());
  for (size_t i = 0; i < depth.pixels().size(); ++i) {
    millimetres.pixels()[i] = static_cast<uint16_t>(std::clamp(std::lround(depth.pixels()[i] * 1000), 0L, 65535L));
  }
  return write_depth_image(path, millimetres);
}

Result<Outcome> run_render(const RenderOptions& options, Console& console) {
  if (std::filesystem::path(options.out).extension() != ".png") throw_option_error("--out: must be a .png file");
  if (options.draw_floor && options.kind != "shaded") throw_option_error("--draw-floor: needs --kind shaded");
  const Result<std::shared_ptr<const BodyModel>> body = choose_body(options.model, context_of(console));
  if (!body) return body.failure();
  const Result<std::vector<double>> pose = read_row(options.pose, (*body)->skeleton);
  if (!pose) return pose.failure();
  const Result<PinholeCamera> camera = choose_camera(options, *body, *pose);
  if (!camera) return camera.failure();

  const Result<void> written = write_whole(options.out, [&](const std::filesystem::path& path) -> Result<void> {
    if (options.kind == "silhouette") return write_mask(path, render_silhouette(**body, *camera, *pose));
    const std::vector<Eigen::Vector3f> vertices = skin_vertices(**body, *pose);
    if (options.kind == "depth") return write_depth(path, draw_depth(*camera, vertices, (*body)->rest.faces));
    ByteImage image(camera->width, camera->height, 3, uint8_t{225});
    draw_shaded(*camera, vertices, (*body)->rest.faces, clothing_colours(**body), {.shadow = 0.3}, image);
    if (options.draw_floor) {
      const Eigen::Vector3d root = landmark_positions(**body, *pose)[0];
      draw_floor(image, *camera, {root.x(), root.z()}, render_silhouette(**body, *camera, *pose));
      draw_footprints(image, **body, *camera, *pose);
    }
    return write_image(path, image);
  });
  if (!written) return written.failure();
  Outcome outcome;
  outcome.json = {{"out", options.out}, {"kind", options.kind}, {"size", {camera->width, camera->height}}};
  outcome.text = fmt::format("{} written to {}", options.kind, options.out);
  return outcome;
}

}  // namespace

Command add_render(CLI::App& program, const CommonOptions&) {
  const auto options = std::make_shared<RenderOptions>();
  CLI::App* const app = program.add_subcommand("render", "Draw one pose");
  app->add_option("--pose", options->pose, "FILE.csv of poses, or FILE.csv:ROW (rows count from 0)")->required();
  app->add_option("--out", options->out, "The image, a .png")->required();
  app->add_option("--kind", options->kind, "silhouette, depth (16 bit, mm) or shaded")
      ->capture_default_str()
      ->check(CLI::IsMember({"silhouette", "depth", "shaded"}));
  app->add_option("--size", options->size, "WIDTHxHEIGHT in pixels, without --camera")->capture_default_str();
  app->add_option("--view", options->view, "front, side, or degrees around the subject, without --camera");
  app->add_flag("--draw-floor", options->draw_floor, "Of a shaded image: the floor y = 0 in 1 m squares, footprints");
  add_model_option(*app, options->model);
  add_camera_options(*app, options->camera);
  return {app, [options](Console& console) { return run_render(*options, console); }};
}

}  // namespace silpose::app
