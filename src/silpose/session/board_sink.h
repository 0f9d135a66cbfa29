// BoardSink: the reports of a session as entries on a blackboard, for readers beside it: a live page, a server.
// Threads: as SessionSink; the board may be shared.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "silpose/recording/track_recorder.h"
#include "silpose/session/sink.h"

namespace silpose {

class BoardSink : public SessionSink {
 public:
  // `cameras`: their names, [C].
  BoardSink(std::shared_ptr<sadb::Blackboard> board, const Skeleton& skeleton, std::vector<std::string> cameras,
            RecorderOptions options = {})
      : recorder_(std::move(board), skeleton, std::move(cameras), std::move(options)) {}

  // Errors: those of the board.
  Result<void> add_report(const StepReport& report) override { return recorder_.put(report); }

 private:
  TrackRecorder recorder_;
};

}  // namespace silpose
