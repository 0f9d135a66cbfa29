#include "curves.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "figure.h"
#include "machine.h"
#include "silhouette_scene.h"
#include "silpose/base/clock.h"
#include "silpose/base/parallel.h"

namespace silpose::bench {
namespace {

// One point of a curve: a scene, how many of its poses are drawn at a time, and on how many threads.
struct Point {
  std::shared_ptr<const SilhouetteScene> scene;
  std::shared_ptr<const BatchRenderer> renderer;
  size_t num_poses = 0;
  int num_threads = 1;
  bool off_body = false;  // the window shows nothing of the body: what is left is skinning and projecting
  // Of a pose, by round: on the clock, and on the processor, where what else the machine does counts less.
  std::vector<double> wall_ns = {}, processor_ns = {};

  void run() const {
    std::vector<OutlineRenderer::Counts> counts(num_poses);
    Window window = scene->window;
    if (off_body) window.x0 += 10 * scene->camera.width;
    renderer->counts(scene->batch(num_poses), window, scene->observed, counts);
    keep(counts);
  }
  void measure_once() {
    const ThreadLimit limit(num_threads);
    const Stopwatch stopwatch;
    const std::clock_t begin = std::clock();
    run();
    processor_ns.push_back(1e9 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC /
                           static_cast<double>(num_poses));
    wall_ns.push_back(1e9 * stopwatch.seconds() / static_cast<double>(num_poses));
  }
};

double median(const std::vector<double>& values) { return quantile(values, 0.5); }
double spread(const std::vector<double>& values) {
  return (quantile(values, 0.75) - quantile(values, 0.25)) / median(values);
}

Point make_point(const std::shared_ptr<const BodyModel>& body, int window, size_t num_poses, int num_threads = 1) {
  auto scene = std::make_shared<const SilhouetteScene>(standing_scene(body, num_poses, window));
  auto renderer = std::make_shared<const BatchRenderer>(body, scene->camera);
  for (const size_t n : {size_t{0}, num_poses - 1}) {
    verify(std::abs(our_distances(*scene, *renderer, n, 1, scene->observed)[0] -
                    plain_distances(*scene, n, 1, scene->observed)[0]) <= 4 * std::max(1, window / 128),
           "distance of a pose");
  }
  return {.scene = scene, .renderer = renderer, .num_poses = num_poses, .num_threads = num_threads};
}

void measure_in_turns(std::vector<Point>& points, int rounds) {
  for (const Point& point : points) point.run();
  for (int round = 0; round < rounds; ++round) {
    for (Point& point : points) point.measure_once();
  }
}

// Work that no way of skinning can avoid: 12 multiply-adds a weight, and the rest position and weights read.
double multiply_adds(const BodyModel& body) { return 12.0 * static_cast<double>(body.skin.weight.size()); }
double skin_bytes(const BodyModel& body) {
  return static_cast<double>(body.rest.vertices.size() * sizeof(Eigen::Vector3f) +
                             body.skin.weight.size() * (sizeof(float) + sizeof(uint16_t)));
}

// Least squares: y = first + second * x.
std::array<double, 2> line_through(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    sx += x[i];
    sy += y[i];
    sxx += x[i] * x[i];
    sxy += x[i] * y[i];
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  return {(sy - slope * sx) / n, slope};
}

class TextFile {
 public:
  explicit TextFile(std::filesystem::path path) : path_(std::move(path)), file_(path_) {}
  void add(const std::string& line) { file_ << line << '\n'; }
  void close() {
    file_.close();
    if (!file_) throw std::runtime_error(path_.string() + ": cannot be written");
  }

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

void write_triangles(const std::filesystem::path& folder, int rounds, const MachineBounds& machine, TextFile& text) {
  const auto full = human();
  std::vector<Point> points;
  for (const int vertices : {500, 1000, 2000, 4000, 8000, 0}) {
    const auto body = level_of_detail(full, vertices);
    points.push_back(make_point(body, 128, 128));
    points.push_back(points.back());
    points.back().off_body = true;
  }
  measure_in_turns(points, rounds);

  TextFile csv(folder / "triangles.csv");
  csv.add("triangles,vertices,weights,pose_ns,spread,outside_ns,inside_ns,multiply_add_bound_ns,read_bound_ns");
  text.add(
      "| triangles | us a pose | with the body outside the window | more with it inside | bound of skinning | the "
      "second over it |");
  text.add("|---|---|---|---|---|---|");
  std::vector<double> triangles, outside;
  for (size_t i = 0; i < points.size(); i += 2) {
    const BodyModel& body = *points[i].scene->body;
    const double pose_ns = median(points[i].processor_ns), outside_ns = median(points[i + 1].processor_ns);
    const double multiply_ns = 1e9 * multiply_adds(body) / machine.multiply_adds_per_s;
    const double read_ns = 1e9 * skin_bytes(body) / machine.bytes_per_s;
    triangles.push_back(static_cast<double>(body.rest.faces.size()));
    outside.push_back(outside_ns);
    csv.add(fmt::format("{},{},{},{:.0f},{:.3f},{:.0f},{:.0f},{:.0f},{:.0f}", body.rest.faces.size(),
                        body.rest.vertices.size(), body.skin.weight.size(), pose_ns, spread(points[i].processor_ns),
                        outside_ns, pose_ns - outside_ns, multiply_ns, read_ns));
    text.add(fmt::format("| {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} | {:.0f} |", body.rest.faces.size(), pose_ns / 1e3,
                         outside_ns / 1e3, (pose_ns - outside_ns) / 1e3, std::max(multiply_ns, read_ns) / 1e3,
                         outside_ns / std::max(multiply_ns, read_ns)));
  }
  csv.close();
  const auto [constant, slope] = line_through(triangles, outside);
  text.add(fmt::format(
      "\nWith the body outside the window a pose takes {:.1f} us and {:.2f} ns ({:.1f} cycles) a triangle. Skinning is "
      "bounded by 12 multiply-adds a weight ({:.1f} us, full mesh) and by reading positions and weights ({:.1f} us).",
      constant / 1e3, slope, slope * machine.clock_hz / 1e9, 1e6 * multiply_adds(*full) / machine.multiply_adds_per_s,
      1e6 * skin_bytes(*full) / machine.bytes_per_s));
}

void write_windows(const std::filesystem::path& folder, int rounds, const MachineBounds& machine, TextFile& text) {
  const auto full = human();
  const std::array bodies = {full, level_of_detail(full, 2000)};
  std::vector<Point> points;
  const std::array sizes = {32, 64, 128, 256, 512, 1024};
  for (const int size : sizes) {
    for (const auto& body : bodies) points.push_back(make_point(body, size, 128));
  }
  measure_in_turns(points, rounds);

  TextFile csv(folder / "window.csv");
  csv.add("size,full_pose_ns,full_spread,lod_pose_ns,lod_spread,read_bound_ns");
  text.add("\n| window | us a pose, full mesh | 2,000 vertices | reading the observed mask takes at least |");
  text.add("|---|---|---|---|");
  std::vector<double> rows, lod_ns;
  for (size_t i = 0; i < sizes.size(); ++i) {
    const std::vector<double>&full_ns = points[2 * i].processor_ns, &coarse_ns = points[2 * i + 1].processor_ns;
    const double read_ns = 1e9 * sizes[i] * sizes[i] / 8 / machine.bytes_per_s;
    rows.push_back(sizes[i]);
    lod_ns.push_back(median(coarse_ns));
    csv.add(fmt::format("{},{:.0f},{:.3f},{:.0f},{:.3f},{:.0f}", sizes[i], median(full_ns), spread(full_ns),
                        median(coarse_ns), spread(coarse_ns), read_ns));
    text.add(fmt::format("| {0}x{0} | {1:.1f} | {2:.1f} | {3:.2f} us |", sizes[i], median(full_ns) / 1e3,
                         median(coarse_ns) / 1e3, read_ns / 1e3));
  }
  csv.close();
  const auto [constant, slope] = line_through(rows, lod_ns);
  text.add(fmt::format("\nWith 2,000 vertices: {:.1f} us and {:.0f} ns ({:.0f} cycles) a row of the window.",
                       constant / 1e3, slope, slope * machine.clock_hz / 1e9));
}

void write_particles(const std::filesystem::path& folder, int rounds, TextFile& text) {
  const auto body = level_of_detail(human(), 2000);
  std::vector<Point> points;
  const std::array<size_t, 8> counts = {1, 4, 16, 64, 256, 1024, 4096, 16384};
  for (const size_t count : counts) {
    points.push_back(make_point(body, 128, count));
    points.push_back(points.back());
    points.back().num_threads = 2;
  }
  measure_in_turns(points, rounds);

  TextFile csv(folder / "particles.csv");
  csv.add(
      "particles,processor_pose_ns,processor_spread,one_thread_pose_ns,one_thread_spread,two_threads_pose_ns,"
      "two_threads_spread,ratio");
  text.add(
      "\n| particles | us a pose, 1 thread, processor time | 1 thread, by the clock | 2 threads, by the clock | ratio "
      "|");
  text.add("|---|---|---|---|---|");
  for (size_t i = 0; i < counts.size(); ++i) {
    const std::vector<double>&alone = points[2 * i].processor_ns, &one = points[2 * i].wall_ns,
          &two = points[2 * i + 1].wall_ns;
    std::vector<double> ratios;
    for (size_t round = 0; round < one.size(); ++round) ratios.push_back(one[round] / two[round]);
    csv.add(fmt::format("{},{:.0f},{:.3f},{:.0f},{:.3f},{:.0f},{:.3f},{:.3f}", counts[i], median(alone), spread(alone),
                        median(one), spread(one), median(two), spread(two), median(ratios)));
    text.add(fmt::format("| {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} |", counts[i], median(alone) / 1e3,
                         median(one) / 1e3, median(two) / 1e3, median(ratios)));
  }
  csv.close();
}

}  // namespace

void write_curves(const std::filesystem::path& folder, int rounds) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw std::runtime_error(fmt::format("{}: {}", folder.string(), failed.message()));
  const MachineBounds machine = measure_machine(static_cast<size_t>(skin_bytes(*human())));
  std::array<double, 1> load = {0};
  getloadavg(load.data(), 1);
  TextFile text(folder / "README.md");
  text.add(fmt::format(R"(# Poses to pixel-count distances

`silpose_bench --curves` on {}; load of the machine at the start: {:.1f}. Medians of {} rounds, every point once a round;
processor time of one thread, and 128x128, unless said. Measured bounds of one thread: {:.2f} GHz, {:.0f} G multiply-adds/s,
{:.0f} GB/s read from a working set as large as the mesh. The CSV files have the spread: interquartile range over median.
)",
                       machine_name(), load[0], rounds, machine.clock_hz / 1e9, machine.multiply_adds_per_s / 1e9,
                       machine.bytes_per_s / 1e9));
  write_triangles(folder, rounds, machine, text);
  write_windows(folder, rounds, machine, text);
  write_particles(folder, rounds, text);
  text.close();
}

}  // namespace silpose::bench
