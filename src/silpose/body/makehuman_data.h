// What MakeHumanData holds. Private to the module `body`: users see human.h.
#pragma once

#include <map>
#include <string>

#include "silpose/body/human.h"
#include "silpose/body/makehuman_files.h"

namespace silpose {

struct MakeHumanData::Impl {
  MakeHumanMesh base;
  SkinWeights skin;                                // of the body vertices on the 20 joints
  std::map<std::string, MakeHumanTarget> targets;  // by name without ".target.gz"
  std::string hash;                                // SHA-256 of the list of all files' SHA-256
};

}  // namespace silpose
