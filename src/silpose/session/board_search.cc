#include "silpose/session/board_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <utility>

#include "silpose/base/option_error.h"
#include "silpose/base/parallel.h"
#include "silpose/video/video.h"

namespace silpose {
namespace {

constexpr int64_t kFramesToSearch = 200;
constexpr int64_t kStepOfUnknown = 10;  // frames, where the video's length is unknown
constexpr size_t kBatch = 8;            // frames in memory at a time

std::string board_text(const Board& board) {
  return fmt::format("chessboard of {}x{} inner corners", board.columns, board.rows);
}

// Finds the board in a batch of frames, in all of their images at once; thoroughly where it lies on the floor.
void search_batch(const Board& board, const std::vector<Frame>& batch, std::optional<int64_t> floor_frame,
                  std::vector<CameraSightings>& cameras) {
  const size_t num_cameras = cameras.size();
  std::vector<std::optional<std::vector<Eigen::Vector2d>>> found(batch.size() * num_cameras);
  parallel_for(found.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Frame& frame = batch[i / num_cameras];
      found[i] = find_board(frame.images[i % num_cameras], board, frame.index == floor_frame);
    }
  });
  for (size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) continue;
    cameras[i % num_cameras].sightings.push_back({batch[i / num_cameras].index, std::move(*found[i])});
  }
}

}  // namespace

Board board_of(const std::string& corners, double square_mm, size_t num_cameras) {
  Board board;
  board.square_m = square_mm / 1000;
  const char* const end = corners.data() + corners.size();
  const auto [cross, bad_columns] = std::from_chars(corners.data(), end, board.columns);
  const bool has_cross = bad_columns == std::errc() && cross != end && *cross == 'x';
  const auto [rest, bad_rows] = has_cross ? std::from_chars(cross + 1, end, board.rows) : std::from_chars_result{end};
  if (!has_cross || bad_rows != std::errc() || rest != end) {
    throw_option_error("--board: {} is not COLUMNSxROWS", corners);
  }
  if (std::min(board.columns, board.rows) < 3 || std::max(board.columns, board.rows) > 50) {
    throw_option_error("--board: {} is outside 3x3 to 50x50 inner corners", corners);
  }
  if (num_cameras > 1 && !board.has_one_way_up()) {
    throw_option_error(
        "--board: {} looks the same upside down, and several cameras would confuse it; one number must be odd and one "
        "even",
        corners);
  }
  return board;
}

std::vector<std::string> camera_names_of(const std::vector<std::string>& videos,
                                         const std::vector<std::string>& given) {
  std::vector<std::string> names = given;
  if (!names.empty() && names.size() != videos.size()) {
    throw_option_error("--camera-name: {} names for {} videos", names.size(), videos.size());
  }
  for (size_t c = names.size(); c < videos.size(); ++c) {
    const std::filesystem::path path = videos[c];
    names.push_back((path.has_filename() ? path : path.parent_path()).stem().string());
  }
  for (const std::string& name : names) {
    if (name.empty() || name.find('/') != std::string::npos) {
      throw_option_error("--camera-name: '{}' is not a valid name", name);
    }
    if (std::ranges::count(names, name) > 1) {
      throw_option_error("two cameras would be named {}; give --camera-name once per video", name);
    }
  }
  return names;
}

Result<BoardSearch> search_board(const Board& board, const std::vector<std::string>& videos,
                                 const std::vector<std::string>& names, std::optional<double> floor_s,
                                 std::optional<double> fps, ProgressSink& progress) {
  Result<Video> video = open_video(videos, {.default_fps = fps.value_or(30)});
  if (!video) return video.failure();
  if (video->is_live()) return error("{}: is live; record it first", video->name());
  BoardSearch search;
  if (floor_s && video->fps_assumed() && !fps) {
    search.warnings.push_back(
        fmt::format("{}: has no frame rate, {} frames per second assumed", video->name(), video->fps()));
  }
  for (size_t c = 0; c < videos.size(); ++c) {
    const int camera = static_cast<int>(c);
    search.cameras.push_back({.name = names[c], .width = video->width(camera), .height = video->height(camera)});
  }
  const int64_t num_frames = video->num_frames_hint();
  const int64_t step = num_frames > 0 ? std::max<int64_t>(1, num_frames / kFramesToSearch) : kStepOfUnknown;

  std::vector<Frame> batch;
  std::optional<int64_t> floor_frame;
  int64_t num_read = 0;
  for (bool at_end = false; !at_end; ++num_read) {
    Result<std::optional<Frame>> frame = video->next();
    if (!frame) return frame.failure();
    at_end = !frame->has_value();
    if (!at_end) {
      const double time_s = static_cast<double>((*frame)->time_ns) * 1e-9;
      const bool is_floor = floor_s && !floor_frame && time_s > *floor_s - 0.5 / video->fps();
      if (is_floor) floor_frame = (*frame)->index;
      if (is_floor || num_read % step == 0) batch.push_back(std::move(**frame));
    }
    if (at_end || batch.size() == kBatch) {
      search_batch(board, batch, floor_frame, search.cameras);
      search.num_searched += std::ssize(batch);
      batch.clear();
    }
    if (!progress.update("looking for the board", num_read, num_frames)) return error("interrupted");
  }

  for (size_t c = 0; c < videos.size(); ++c) {
    if (!search.cameras[c].sightings.empty()) continue;
    return error("{}: no {} in any of {} frames; it must be whole in the image, with a white margin", videos[c],
                 board_text(board), search.num_searched);
  }
  if (!floor_s) return search;
  if (!floor_frame)
    return error("{}: ends before {:g} s, where the board is said to lie on the floor", videos[0], *floor_s);
  const bool is_seen = std::any_of(search.cameras.begin(), search.cameras.end(), [&](const CameraSightings& camera) {
    return std::any_of(camera.sightings.begin(), camera.sightings.end(),
                       [&](const Sighting& sighting) { return sighting.instant == floor_frame; });
  });
  if (!is_seen) {
    return error("{}: no {} at {:g} s (frame {}), where it is said to lie on the floor", fmt::join(videos, ", "),
                 board_text(board), *floor_s, *floor_frame);
  }
  search.floor_instant = floor_frame;
  return search;
}

}  // namespace silpose
