// Segmenter: picture to mask of the subject, by a background model, by a trained network, or by masks that are given;
// and how far the mask can be trusted. Based on: background_model.h, OpenCV's mixtures (references.bib: zivkovic2004,
// zivkovic2006), person_network.h, clean_up.h. Threads: one thread per segmenter; works on all cores itself.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/image/observation.h"
#include "silpose/segment/clean_up.h"
#include "silpose/segment/depth_model.h"
#include "silpose/segment/screen_model.h"

namespace silpose {

class Segmenter {
 public:
  virtual ~Segmenter() = default;

  // The mask of picture number `index` of the video, [H, W, 3] B, G, R. Indices rise from call to call and may skip.
  // Errors: the picture has another size than those learned from; given masks that end, break or have another size.
  virtual Result<Observation> segment(const ByteImage& image, int64_t index) = 0;

  // Does the part of segment() that does not need the expected silhouette; segment() of that picture then takes less
  // time and gives the same result. While it runs only expect() may be called.
  virtual void prepare(const ByteImage& /*image*/, int64_t /*index*/) {}

  // Where the subject is expected in the next picture, [H, W]; empty: unknown. It helps to choose among blobs
  // (choose_blob()) and never becomes foreground by itself. A network needs no such help.
  virtual void expect(Mask /*silhouette*/) {}  // NOLINT(performance-unnecessary-value-param): others keep it

  // Whether its observations have keypoints.
  [[nodiscard]] virtual bool finds_keypoints() const { return false; }

  // Pixels of which none of its observations knows anything; null: none.
  [[nodiscard]] virtual std::shared_ptr<const Mask> ignored() const { return {}; }

  // Pictures before this one serve to learn from and are not to be tracked.
  [[nodiscard]] virtual int64_t first_index() const { return 0; }

  // Learns from every picture: also those that are not to be tracked must be shown to it.
  [[nodiscard]] virtual bool sees_all() const { return false; }

  // Whether it can be shown earlier pictures again after restore().
  [[nodiscard]] virtual bool can_go_back() const { return !sees_all(); }

  // What it carries from picture to picture besides that: another one with the same options continues from it as this
  // one would.
  // Errors: restore() throws std::invalid_argument for what is no such state.
  [[nodiscard]] virtual std::string state() const { return {}; }
  virtual void restore(std::string_view state) { check(state.empty(), "Segmenter: not a state of it"); }

  // What the user should know about this input, one line each; may grow while it runs.
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }

  // "background auto", "background online", "learned", "masks", ...: for the result's settings.
  [[nodiscard]] virtual std::string name() const = 0;
};

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
