// Tracks the person in frames that the program has in memory: track_frames BODY.body CALIBRATION.toml FOLDER FPS.
// Prints `frame time_s visual_accuracy`, one line per frame. Here the frames are the image files of a folder; they may
// come from anywhere.
#include <fmt/format.h>
#include <silpose/silpose.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 5) {
    fmt::print(stderr, "usage: track_frames BODY.body CALIBRATION.toml FOLDER FPS\n");
    return 2;
  }
  try {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(argv[3])) files.push_back(entry.path());
    std::ranges::sort(files);
    std::vector<silpose::ByteImage> images;
    for (const auto& file : files) images.push_back(silpose::read_colour_image(file).value());

    std::vector<std::unique_ptr<silpose::FrameSource>> sources;  // one per camera
    sources.push_back(std::make_unique<silpose::MemorySource>(std::move(images), std::atof(argv[4])));
    auto frames = silpose::join_sources(std::move(sources)).value();
    const auto segmenter = silpose::make_segmenter(frames).value();  // the kind follows from the frames
    frames.rewind().value();

    const auto body = std::make_shared<silpose::BodyModel>(silpose::load_body(argv[1]).value());
    silpose::Tracker tracker({.body = body, .cameras = silpose::load_cameras(argv[2]).value(), .seed = 1});
    for (const silpose::Frame& frame : frames) {
      const silpose::Observation seen = segmenter->segment(frame.images[0], frame.index).value();
      const silpose::StepReport report = tracker.step({&seen, 1}, frame.index, frame.time_ns);
      fmt::print("{} {:.4f} {:.4f}\n", frame.index, report.time_s(), report.visual_accuracy);
    }
  } catch (const std::exception& failure) {
    fmt::print(stderr, "track_frames: {}\n", failure.what());
    return 1;
  }
  return 0;
}
