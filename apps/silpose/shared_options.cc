#include "apps/silpose/shared_options.h"

#include <charconv>

#include "apps/silpose/table_options.h"
#include "silpose/session/body_choice.h"

namespace silpose::app {

void add_common_options(CLI::App& command, CommonOptions& common) {
  command.add_option("--seed", common.program.seed, "Seed of all random numbers (same seed, same bytes)")
      ->capture_default_str()
      ->check(CLI::Validator(
          [](const std::string& text) -> std::string {
            uint64_t seed = 0;
            const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), seed);
            return bad == std::errc() && end == text.data() + text.size() ? "" : text + " is not a whole number from 0";
          },
          ""));
  command.add_option("--threads", common.threads, "At most this many (0: all cores)")->check(CLI::Range(0, 1024));
  command.add_flag("--quiet", common.quiet, "No progress, no messages");
  command.add_flag("--json", common.json, "One JSON object on standard output");
}

void add_input_options(CLI::App& command, InputOptions& options) {
  command.add_option("VIDEO", options.videos, "A file, a folder of images, a pattern (img-%06d.png) or camera:N");
  add_table_options(command, segmentation_option_table(), options.segmentation);
  add_table_options(command, input_option_table(), options);
}

void add_camera_options(CLI::App& command, CameraOptions& options) {
  add_table_options(command, camera_option_table(), options);
}

CLI::Validator is_model() {
  return CLI::Validator(
      [](const std::string& model) {
        const Result<void> fits = check_model(model);
        return fits ? std::string() : fits.error().message;
      },
      "");
}

void add_model_option(CLI::App& command, std::string& model) {
  command
      .add_option(
          "--model", model,
          "The body: human, human:age=30,sex=f,height=1.62,weight=58,muscle=0.5 (years, m, kg), or a .body file")
      ->capture_default_str()
      ->check(is_model());
}

void add_body_file_option(CLI::App& command, std::string& out) {
  command.add_option("--out", out, "The .body file to write")
      ->required()
      ->check(CLI::Validator(
          [](const std::string& path) {
            return std::filesystem::path(path).extension() == ".body" ? "" : path + ": does not end in .body";
          },
          "FILE.body"));
}

}  // namespace silpose::app
