// Tracks the person in frames that the program has in memory: track_frames FOLDER CALIBRATION.toml [BODY.body [FPS]].
// Prints `frame time_s visual_accuracy`, one line per frame. Here the frames are the image files of a folder; they may
// come from anywhere. The body is the installed average person and there are 30 frames per second, if not given.
#include <fmt/format.h>
#include <silpose/base/data_folder.h>
#include <silpose/silpose.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

int main(int argc, char** argv) {
  if (argc < 3 || argc > 5) {
    fmt::print(stderr, "usage: track_frames FOLDER CALIBRATION.toml [BODY.body [FPS]]\n");
    return 2;
  }
  try {
    const std::filesystem::path body = argc > 3 ? argv[3] : silpose::data_directory() / "human.body";
    const double fps = argc > 4 ? std::atof(argv[4]) : 30;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) files.push_back(entry.path());
    std::ranges::sort(files);
    std::vector<silpose::ByteImage> images;
    for (const auto& file : files) images.push_back(silpose::read_colour_image(file).value());

    std::vector<std::unique_ptr<silpose::FrameSource>> sources;  // one per camera
    sources.push_back(std::make_unique<silpose::MemorySource>(std::move(images), fps));
    // What the frames show decides how the person is cut out of them; SourceOptions says it otherwise.
    auto source = silpose::ObservationSource::open(silpose::join_sources(std::move(sources)).value()).value();

    silpose::TrackerOptions tracker;
    tracker.body = std::make_shared<silpose::BodyModel>(silpose::load_body(body).value());
    tracker.cameras = silpose::load_cameras(argv[2]).value();
    silpose::Session session(*source, {.tracker = std::move(tracker)});
    while (const auto report = session.next().value()) {
      fmt::print("{} {:.4f} {:.4f}\n", report->frame_idx, report->time_s(), report->visual_accuracy);
    }
  } catch (const std::exception& failure) {
    fmt::print(stderr, "track_frames: {}\n", failure.what());
    return 1;
  }
  return 0;
}
