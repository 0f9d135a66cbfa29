// Tracks the person in a clip: track_video BODY.body CALIBRATION.toml VIDEO. Prints one line per frame.
#include <fmt/format.h>
#include <silpose/silpose.h>

#include <exception>
#include <memory>
#include <utility>

int main(int argc, char** argv) {
  if (argc != 4) {
    fmt::print(stderr, "usage: track_video BODY.body CALIBRATION.toml VIDEO\n");
    return 2;
  }
  try {
    // Learns the background from the clip, reads it again and tracks.
    auto source = silpose::ObservationSource::open(silpose::open_video(argv[3]).value()).value();
    silpose::TrackerOptions tracker;
    tracker.body = std::make_shared<silpose::BodyModel>(silpose::load_body(argv[1]).value());
    tracker.cameras = silpose::load_cameras(argv[2]).value();
    silpose::Session session(*source, {.tracker = std::move(tracker)});
    while (const auto report = session.next().value()) {
      fmt::print("{:.3f} s  visual accuracy {:.2f}\n", report->time_s(), report->visual_accuracy);
    }
  } catch (const std::exception& failure) {
    fmt::print(stderr, "track_video: {}\n", failure.what());
    return 1;
  }
  return 0;
}
