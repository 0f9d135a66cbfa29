// The MakeHuman data in memory, checked by hash. Private to the module `body`: users see human.h.
// Threads: constant after loading.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "silpose/human/human.h"
#include "silpose/human/makehuman_files.h"

namespace silpose {

struct MakeHumanAssets {
  MakeHumanMesh base;
  SkinWeights skin;                                // of the body vertices on the 20 joints
  std::map<std::string, MakeHumanTarget> targets;  // by name without ".target.gz"
  std::string hash;                                // SHA-256 of the list of all files' SHA-256
};

// Errors: as MakeHumanData::load.
Result<MakeHumanAssets> load_makehuman_assets(const std::filesystem::path& directory);

struct MakeHumanData::Impl {
  MakeHumanAssets assets;
};

}  // namespace silpose
