// Segmenter: from an image to the observation of the subject: mask, confidence, ignored pixels, keypoints, trust.
// Threads: one thread per segmenter; works on all cores itself.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/result.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/image/observation.h"

namespace silpose {

class Segmenter {
 public:
  virtual ~Segmenter() = default;

  // The observation of image number `index` of the video, [H, W, 3] B, G, R. Indices rise from call to call and may
  // skip. Errors: the image has another size than those learned from; given masks that end, break or have another
  // size.
  virtual Result<Observation> segment(const ByteImage& image, int64_t index) = 0;

  // Does the part of segment() that does not need the expected silhouette; segment() of that image then takes less
  // time and gives the same result. While it runs only expect() may be called.
  virtual void prepare(const ByteImage& /*image*/, int64_t /*index*/) {}

  // Where the subject is expected in the next image, [H, W]; empty: unknown. It helps to choose among blobs
  // (choose_blob()) and never becomes foreground by itself. A network needs no such help.
  virtual void expect(Mask /*silhouette*/) {}  // NOLINT(performance-unnecessary-value-param): others keep it

  // Whether its observations have keypoints.
  [[nodiscard]] virtual bool finds_keypoints() const { return false; }

  // Pixels of which none of its observations knows anything; null: none.
  [[nodiscard]] virtual std::shared_ptr<const Mask> ignored() const { return {}; }

  // Images before this one serve to learn from and are not to be tracked.
  [[nodiscard]] virtual int64_t first_index() const { return 0; }

  // Learns from every image: also those that are not to be tracked must be shown to it.
  [[nodiscard]] virtual bool sees_all() const { return false; }

  // Whether it can be shown earlier images again after restore().
  [[nodiscard]] virtual bool can_go_back() const { return !sees_all(); }

  // What it carries from image to image besides that: another one with the same options continues from it as this
  // one would.
  // Errors: restore() throws std::invalid_argument for what is no such state.
  [[nodiscard]] virtual std::string state() const { return {}; }
  virtual void restore(std::string_view state) { check(state.empty(), "Segmenter: not a state of it"); }

  // What the user should know about this input, one line each; may grow while it runs.
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }

  // "background auto", "background online", "learned", "masks", ...: for the result's settings.
  [[nodiscard]] virtual std::string name() const = 0;
};

}  // namespace silpose
