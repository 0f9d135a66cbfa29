// The segmenter by a network trained on people: no background is needed, and none learned. A person is detected in the
// whole image (or the region) and then followed from image to image. Made by make_segmenter().
// Based on: person_network.h, plate.h, edge_matte.h.
// Threads: one thread per segmenter; works on all cores itself.
#pragma once

#include <memory>
#include <optional>

#include "silpose/segment/background_model.h"
#include "silpose/segment/clean_up.h"
#include "silpose/segment/person_network.h"
#include "silpose/segment/segmenter.h"

namespace silpose {

// With samples of a clip from a static camera: what is behind the person is learned from them, and the mask's edge
// follows it where it is known.
std::unique_ptr<Segmenter> make_learned_segmenter(PersonNetwork network, PersonDetector detector,
                                                  const CleanUpOptions& clean_up,
                                                  const std::optional<BackgroundSamples>& samples = {});

}  // namespace silpose
