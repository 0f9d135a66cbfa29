// DegradedMasks: the silhouettes of a SyntheticSequence with the faults that segmentation makes. The sequence's true
// poses and joints stay unchanged.
// Threads: const functions are safe; a mask is the same whichever thread draws it, and in whatever order.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/synth/outline_noise.h"
#include "silpose/synth/scene.h"

namespace silpose {

enum class MaskFault {
  kNone,
  kShadow,  // the body's whole shadow on the floor is mistaken for the body; it falls as in colour images
  kEdge,    // the outline wanders about the true one
  kLimb,    // a limb's segment (a joint's share of the mesh) is not seen for 0.3 to 1 s at a time
  kHole,    // up to five blobs inside are missing; they stay on the body for 0.3 to 1.2 s each
};

struct MaskNoise {
  MaskFault fault = MaskFault::kNone;
  double iou = 0.9;             // of kEdge: mean intersection over union with the true masks of one camera, 0 to 1
  OutlineNoiseOptions outline;  // of kEdge
  uint64_t seed = 1;
};

// "none", "shadow", "edge", "limb" or "hole". Errors: anything else.
Result<MaskFault> parse_mask_fault(const std::string& text);

class DegradedMasks {
 public:
  // The amplitude of kEdge is searched for so that the wanted mean is met over the frames with a body. The sequence
  // must outlive this. Errors: an intersection over union that the outline noise cannot reach; a body without limbs;
  // throws std::invalid_argument for no such camera, or an intersection over union that is not above 0 and below 1.
  static Result<DegradedMasks> create(const SyntheticSequence& sequence, int camera_idx, const MaskNoise& noise);

  // Frame `frame`, counted from the video's first image; empty in the lead-in.
  [[nodiscard]] Mask draw(int frame) const;

  // Mean intersection over union with the true masks, measured over all frames with a body; 1 when there is none.
  [[nodiscard]] double mean_iou() const { return mean_iou_; }

 private:
  DegradedMasks(const SyntheticSequence& sequence, int camera_idx) : sequence_(&sequence), camera_idx_(camera_idx) {}
  void measure();

  const SyntheticSequence* sequence_;
  int camera_idx_;
  double mean_iou_ = 1;
  std::function<Mask(int)> fault_;  // a frame with a body to its mask
};

// All masks of one camera [lead_in + T]. Errors: see DegradedMasks::create().
Result<std::vector<Mask>> degraded_masks(const SyntheticSequence& sequence, int camera_idx, const MaskNoise& noise);

}  // namespace silpose
