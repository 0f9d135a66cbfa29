// The Segmenter that options ask for, of one camera's input: by a background model, by a coloured screen, by depth, by
// a trained network, or by masks that are given. Based on: background_model.h, OpenCV's mixtures (references.bib:
// zivkovic2004, zivkovic2006), screen_model.h, depth_model.h, person_network.h, clean_up.h. Threads: a function without
// state; works on all cores itself.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/segment/clean_up.h"
#include "silpose/segment/depth_model.h"
#include "silpose/segment/key_colour.h"
#include "silpose/segment/segmenter.h"

namespace silpose {

struct SegmenterOptions {
  std::string kind = "auto";  // auto, background, chroma, depth, learned, masks
  std::string background;     // auto, online, online:knn, lead-in:SECONDS, a video, a picture; empty: none
  std::string networks;       // folder of what scripts/fetch-network-data fetches
  // A directory, a pattern, a video; empty with kind masks: the input itself. As many as frames belong to them in
  // order, otherwise mask number i to frame number i.
  std::string masks;
  std::optional<KeyColour> key_colour;  // of the screen; absent: found from the clip
  // 16-bit pictures in mm: a directory or a pattern; to frames as masks are. With kind background they are used
  // together with the colours.
  std::string depth;
  std::optional<DepthRange> depth_range;
  double default_fps = 30;  // of input that carries no rate
  CleanUpOptions clean_up;  // given masks stay as they are unless a region, a garbage mask or growth is asked for
};

// For one camera's input as open_video() takes it. Reads the input, or its lead-in, once where a background is learned
// from it. `auto` is masks where masks are given, background where one is asked for, masks where the input itself is
// black and white alone, otherwise learned if `networks` is there and background `auto` if not; a live input's
// background is learned online. Errors: unknown kind or background; the input, the plate, the masks or the depth cannot
// be read, or have another size than the input; masks or depth that end before the frames do; no screen to key by; no
// frame in the lead-in; the networks are not there or damaged; stopped by the progress sink.
Result<std::unique_ptr<Segmenter>> make_segmenter(const std::string& input, const SegmenterOptions& options = {},
                                                  ProgressSink* progress = nullptr);

}  // namespace silpose
