// Tracks the person in a clip: track_video BODY.body CALIBRATION.toml VIDEO. Prints one line per frame.
#include <fmt/format.h>
#include <silpose/silpose.h>

#include <exception>
#include <memory>

int main(int argc, char** argv) {
  if (argc != 4) {
    fmt::print(stderr, "usage: track_video BODY.body CALIBRATION.toml VIDEO\n");
    return 2;
  }
  try {
    const auto body = std::make_shared<silpose::BodyModel>(silpose::load_body(argv[1]).value());
    const auto cameras = silpose::load_cameras(argv[2]).value();
    auto video = silpose::open_video(argv[3]).value();
    const auto segmenter = silpose::make_segmenter(video).value();  // learns the background from the clip
    video.rewind().value();
    silpose::Tracker tracker({.body = body, .cameras = cameras, .seed = 1});
    for (const silpose::Frame& frame : video) {
      const silpose::Observation seen = segmenter->segment(frame.images[0], frame.index).value();
      const silpose::StepReport report = tracker.step({&seen, 1}, frame.index, frame.time_ns);
      fmt::print("{:.3f} s  visual accuracy {:.2f}\n", report.time_s(), report.visual_accuracy);
    }
  } catch (const std::exception& failure) {
    fmt::print(stderr, "track_video: {}\n", failure.what());
    return 1;
  }
  return 0;
}
