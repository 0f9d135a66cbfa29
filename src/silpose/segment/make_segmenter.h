// The Segmenter that options ask for, for one camera: by a background model, by a coloured screen, by depth, by
// a trained network, or by masks that are given. Based on: background_model.h, OpenCV's mixtures (references.bib:
// zivkovic2004, zivkovic2006), screen_model.h, depth_model.h, person_network.h, clean_up.h. Threads: a function without
// state; works on all cores itself.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/segment/background_origin.h"
#include "silpose/segment/clean_up.h"
#include "silpose/segment/depth_model.h"
#include "silpose/segment/key_colour.h"
#include "silpose/segment/segmenter.h"
#include "silpose/video/video.h"

namespace silpose {

struct SegmenterOptions {
  std::string kind = "auto";  // auto, background, chroma, depth, learned, masks
  std::optional<BackgroundOrigin> background;
  std::string networks;  // folder of what scripts/fetch-network-data fetches
  // A directory, a pattern, a video; empty with kind masks: the input itself. As many as frames belong to them in
  // order, otherwise mask number i to frame number i.
  std::string masks;
  std::optional<KeyColour> key_colour;  // of the screen; absent: found from the clip
  // 16-bit images in mm: a directory or a pattern; to frames as masks are. With kind background they are used
  // together with the colours.
  std::string depth;
  std::optional<DepthRange> depth_range;
  CleanUpOptions clean_up;  // given masks stay as they are unless a region, a garbage mask or growth is asked for
};

// For the frames of `video`. What has to be learned is learned from it, from its first frame on: rewind() it before its
// next frame. `auto` is masks where masks are given, background where one is asked for, masks where the frames
// themselves are black and white only, otherwise learned if `networks` is there and background from the clip if not;
// the background of a live camera is learned online. Errors: unknown kind; the video, the plate, the masks or the depth
// cannot be read, or have another size than the video; masks or depth that end before the frames do; no screen to key
// by; no frame in the lead-in; the networks are not there or damaged; stopped by the progress sink.
// REQUIRES: a video of one camera.
Result<std::unique_ptr<Segmenter>> make_segmenter(Video& video, const SegmenterOptions& options = {},
                                                  ProgressSink* progress = nullptr);

}  // namespace silpose
