// `silpose track` as a user runs it: from a file to a result directory, the program's start included.
#include <fmt/format.h>
#include <stdlib.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "benches.h"

namespace silpose::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kLeadIn = 15, kFrames = 150;
constexpr const char* kModel = "human:height=1.69";

// What a command prints on its standard output. Errors: throws std::runtime_error unless it exits 0.
std::string output_of(const std::string& command) {
  FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot run " + command);
  std::string output;
  std::array<char, 4096> buffer;
  for (size_t count = 0; (count = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    output.append(buffer.data(), count);
  }
  if (pclose(pipe) != 0) throw std::runtime_error(fmt::format("failed: {}: {}", command, output));
  return output;
}

// A folder of its own under the system's temporary ones, removed in the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (fs::temp_directory_path() / "silpose_bench.XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
    path_ = pattern;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] std::string operator/(const char* name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

// `least_accuracy`: intersection over union with the true masks that a result must have to be timed.
Figure track_fps(const std::string& options, double least_accuracy, int rounds) {
  const fs::path silpose = fs::read_symlink("/proc/self/exe").parent_path() / "silpose";
  const ScratchFolder folder;
  const std::string truth = folder / "truth", result = folder / "result", video = folder / "truth/video.mp4";
  const auto run = [&](const std::string& arguments) {
    return nlohmann::json::parse(output_of(fmt::format("'{}' {} --quiet --json", silpose.string(), arguments)));
  };
  run(fmt::format("synth --motion sway --model {} --frames {} --lead-in {} --colour --out '{}'", kModel, kFrames,
                  kLeadIn, truth));
  const std::string track = fmt::format(
      "track '{}' --model {} --segmenter background --background lead-in:{} --camera '{}/camera.toml' "
      "--out '{}' {}",
      video, kModel, kLeadIn / 30.0, truth, result, options);

  verify(run(track)["frames_tracked"] == kFrames, "frames tracked");
  const nlohmann::json errors = run(fmt::format("evaluate --result '{}' --truth '{}'", result, truth));
  verify(errors["visual_accuracy"]["mean"] >= least_accuracy, "visual accuracy");
  verify(fs::file_size(fs::path(result) / "overlay.mp4") > 0, "overlay");

  const double amount = kLeadIn + kFrames;
  std::vector<Contestant> peers;
  if (fs::exists(SILPOSE_BENCH_PYTHON)) {
    const std::string mediapipe = fmt::format("'{}' '{}' '{}' '{}' 2>/dev/null", SILPOSE_BENCH_PYTHON,
                                              SILPOSE_BENCH_MEDIAPIPE, video, folder / "mediapipe.mp4");
    verify(nlohmann::json::parse(output_of(mediapipe))["found"] >= kFrames * 9 / 10, "poses that MediaPipe finds");
    peers.push_back({.name = "MediaPipe Pose 0.10.14 (full, Python), overlay written", .amount = amount, .run = [=] {
                       keep(output_of(mediapipe));
                     }});
  } else {
    fmt::print(stderr, "silpose_bench: no MediaPipe peer (scripts/install-bench-peers)\n");
  }
  return measure({.unit = "frames/s", .rounds = rounds},
                 {.name = "ours", .amount = amount, .run = [&] { keep(run(track)); }}, peers);
}

}  // namespace

Figure track_vga_fps(int rounds) { return track_fps("--preset default", 0.85, rounds); }
Figure track_vga_particles_fps(int rounds) { return track_fps("--particles 1000 --layers 1", 0.7, rounds); }

}  // namespace silpose::bench
