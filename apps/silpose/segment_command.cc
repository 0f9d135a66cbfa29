// silpose segment: masks only.
#include <fmt/format.h>

#include <memory>

#include "apps/silpose/config_file.h"
#include "apps/silpose/shared_options.h"
#include "silpose/base/option_error.h"
#include "silpose/image/image_file.h"
#include "silpose/session/result_directory.h"
#include "silpose/session/run_facts.h"

namespace silpose::app {
namespace {

struct SegmentOptions {
  InputOptions input;
  std::string out, config;
};

Result<Outcome> run_segment(const CLI::App& app, const SegmentOptions& options, const CommonOptions& common,
                            Console& console) {
  if (options.out.empty()) throw_option_error("--out is missing");
  if (options.input.videos.size() > 1) throw_option_error("VIDEO: only one is allowed");
  Result<ResultDirectory> directory = ResultDirectory::create(options.out);
  if (!directory) return directory.failure();
  Result<Video> video = open_input(options.input);
  if (!video) return video.failure();
  const auto opened = observations_of(std::move(*video), options.input, context_of(console));
  if (!opened) return opened.failure();
  ObservationSource* const source = opened->get();
  std::error_code failed;  // the first mask would report it
  std::filesystem::create_directories(directory->path() / "masks", failed);

  int64_t frames = 0, empty = 0;
  double decode_s = 0, segment_s = source->learning_s(), area = 0;
  bool stopped = false;
  while (!stopped) {
    const Result<std::optional<Instant>> instant = source->next();
    if (!instant) return instant.failure();
    if (!instant->has_value()) break;
    const Instant& now = **instant;
    const auto written =
        write_mask(directory->path() / "masks" / fmt::format("{:06}.png", now.frame.index), now.observations[0].mask);
    if (!written) return written.failure();
    ++frames;
    empty += now.observations[0].trust.nothing_found ? 1 : 0;
    area += static_cast<double>(now.observations[0].mask.count());
    decode_s += now.decode_s;
    segment_s += now.segment_s;
    stopped = !console.update("segmenting", frames, source->num_expected());
  }
  stopped = stopped || Console::interrupted();
  std::vector<std::string> warnings = warnings_of(*source, options.input);
  if (frames == 0 && !stopped) return error("{}: no frame between --start and --end", source->video().name());
  if (empty == frames) warnings.push_back("no person was seen");
  for (const std::string& warning : warnings) console.warning(warning);

  Outcome outcome;
  outcome.json = run_facts(common.program);
  outcome.json["frames"] = frames;
  outcome.json["frames_empty"] = empty;
  outcome.json["mean_area_px"] = area / static_cast<double>(std::max<int64_t>(1, frames));
  outcome.json["stages_s"] = {{"decode", decode_s}, {"segment", segment_s}};
  outcome.json["background"] = source->segmentation();
  outcome.json["warnings"] = warnings;
  outcome.json["out"] = options.out;
  outcome.text =
      fmt::format("{} masks in {}/masks, {} of them empty ({})", frames, options.out, empty, source->segmentation());
  outcome.interrupted = stopped;
  return deliver(*directory, app, {}, std::move(outcome), console);
}

}  // namespace

Command add_segment(CLI::App& program, const CommonOptions& common) {
  const auto options = std::make_shared<SegmentOptions>();
  CLI::App* const app = program.add_subcommand("segment", "Cut the person out of a clip: masks only");
  add_input_options(*app, options->input);
  app->add_option("--out", options->out, "Directory for masks/ and run.json");
  add_config_option(*app, options->config);
  return {app, [app, options, &common](Console& console) { return run_segment(*app, *options, common, console); },
          &options->config};
}

}  // namespace silpose::app
