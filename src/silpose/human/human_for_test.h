// For tests: the human of the fetched body data, built once in a test program. Threads: one.
#pragma once

#include <map>
#include <memory>

#include "silpose/human/human.h"

namespace silpose {

// The average person with about `vertices` vertices; 0: the whole mesh.
inline std::shared_ptr<const BodyModel> human_for_test(int vertices = 0) {
  static std::map<int, std::shared_ptr<const BodyModel>> kept;
  std::shared_ptr<const BodyModel>& body = kept[vertices];
  if (body) return body;
  if (vertices == 0) {
    body = std::make_shared<const BodyModel>(
        build_human(MakeHumanData::load(SILPOSE_DATA_DIR "/makehuman").value(), {}).value());
  } else {
    body = std::make_shared<const BodyModel>(level_of_detail(*human_for_test(), vertices));
  }
  return body;
}

}  // namespace silpose
