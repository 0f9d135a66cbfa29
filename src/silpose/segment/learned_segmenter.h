// The segmenter that knows what a person looks like: no background is needed, and none learned. A person is sought in
// the whole picture (or the region) and then followed from picture to picture. Made by make_segmenter().
// Based on: person_network.h.
// Threads: one thread per segmenter; works on all cores itself.
#pragma once

#include <memory>

#include "silpose/segment/person_network.h"
#include "silpose/segment/segmenter.h"

namespace silpose {

std::unique_ptr<Segmenter> make_learned_segmenter(PersonNetwork network, PersonDetector detector,
                                                  const CleanUpOptions& clean_up);

}  // namespace silpose
