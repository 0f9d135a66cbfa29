// The segmenter by depth images, one per image: what is in front of the scene, or in a range of depths. Made by
// make_segmenter().
// Threads: one thread per segmenter.
#pragma once

#include <memory>
#include <optional>

#include "silpose/base/progress.h"
#include "silpose/segment/clean_up.h"
#include "silpose/segment/depth_files.h"
#include "silpose/segment/depth_model.h"
#include "silpose/segment/segmenter.h"

namespace silpose {

// Without a range the background is learned from the clip. Errors: a file that cannot be read, is not 16-bit or has
// another size than width x height; stopped by the progress sink.
Result<std::unique_ptr<Segmenter>> make_depth_segmenter(DepthFiles depth, const std::optional<DepthRange>& range,
                                                        const CleanUpOptions& clean_up, ProgressSink* progress);

}  // namespace silpose
