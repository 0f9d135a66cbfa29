// Records a track on a blackboard and reads it by time: recording BODY.body CALIBRATION.toml VIDEO DOF. Prints the
// angle of a DOF (such as left_shin_rx) every 10 ms, between frames too.
#include <fmt/format.h>
#include <sadb/board/time_access.h>
#include <sadb/store/memory_store.h>
#include <silpose/session/board_sink.h>
#include <silpose/silpose.h>

#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

int main(int argc, char** argv) try {
  if (argc != 5) return fmt::print(stderr, "usage: recording BODY.body CALIBRATION.toml VIDEO DOF\n"), 2;
  silpose::TrackerOptions tracker;
  tracker.body = std::make_shared<silpose::BodyModel>(silpose::load_body(argv[1]).value());
  tracker.cameras = silpose::load_cameras(argv[2]).value();
  const auto dof = static_cast<size_t>(tracker.body->skeleton.find_dof(argv[4]).value());
  const auto board = std::make_shared<sadb::MemoryStore>();
  const auto sink =
      std::make_shared<silpose::BoardSink>(board, tracker.body->skeleton, std::vector{tracker.cameras.front().name});
  auto source = silpose::ObservationSource::open(silpose::open_video(argv[3]).value()).value();
  silpose::Session session(*source, {.tracker = tracker, .sinks = {sink}});
  while (session.next().value()) {
  }

  if (board->count("tracker/pose").value() == 0) throw std::runtime_error("nobody was tracked");
  const auto entries = sadb::read_range(*board, "tracker/pose").value();
  constexpr int64_t kStep_ns = 10'000'000;
  for (int64_t time_ns = entries.front().time_ns; time_ns <= entries.back().time_ns; time_ns += kStep_ns) {
    const auto reading = board->get("tracker/pose", time_ns, {.method = sadb::Method::kLinear}).value();
    fmt::print("{:.2f} s  {:.4f}  {}\n", 1e-9 * static_cast<double>(time_ns),
               std::get<sadb::Pose>(reading.value).values[dof], sadb::how_name(reading.how));
  }
} catch (const std::exception& failure) {
  fmt::print(stderr, "recording: {}\n", failure.what());
  return 1;
}
