#include "silpose/human/makehuman_assets.h"

#include <openssl/evp.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "silpose/base/parallel.h"
#include "silpose/base/text_file.h"

namespace silpose {
namespace {

// Of the list "HASH  PATH\n" over all files in path order: the file SHA256SUMS that scripts/fetch-body-data checks.
constexpr std::string_view kListSha256 = "11f062edd71ce7b6d52440e6ad418b13ed84b159364684bf40cadf4b5a2169c2";
constexpr size_t kMaxTargetBytes = 8 << 20;

std::vector<std::string> target_names() {
  std::vector<std::string> names;
  for (const char* gender : {"female", "male"}) {
    for (const char* age : {"old", "young"}) {
      const std::string who = fmt::format("{}-{}", gender, age);
      for (const char* race : {"african", "asian", "caucasian"}) names.push_back(fmt::format("{}-{}", race, who));
      for (const char* muscle : {"minmuscle", "averagemuscle", "maxmuscle"}) {
        for (const char* weight : {"minweight", "averageweight", "maxweight"}) {
          const std::string build = fmt::format("{}-{}-{}", who, muscle, weight);
          names.push_back("universal-" + build);
          for (const char* last : {"minheight", "maxheight", "idealproportions", "uncommonproportions"}) {
            names.push_back(fmt::format("{}-{}", build, last));
          }
        }
      }
    }
  }
  return names;
}

std::string sha256(std::string_view bytes) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  EVP_Digest(bytes.data(), bytes.size(), digest, &size, EVP_sha256(), nullptr);
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

// The bones of the default rig that carry the thesis' joints; all others belong to the nearest of these above them.
std::map<std::string, int> joint_from_bone() {
  std::map<std::string, int> map = {{"root", 0},    {"spine05", 0}, {"spine04", 1}, {"spine03", 1},
                                    {"spine02", 2}, {"spine01", 2}, {"neck01", 3}};
  int joint = 4;
  for (const char* part :
       {"pelvis", "upperleg01", "lowerleg01", "foot", "clavicle", "upperarm01", "lowerarm01", "wrist"}) {
    if (joint == 8) joint = 12;
    map[fmt::format("{}.R", part)] = joint;
    map[fmt::format("{}.L", part)] = joint + 4;
    ++joint;
  }
  return map;
}

struct AssetFile {
  std::string where;        // for messages
  const std::string& path;  // in the data's folder
  const std::string& content;
};

// Reads a file into its part of the assets, if it has one. `rig`: the content of the file of bones.
Result<void> parse_asset(const AssetFile& file, const std::string& rig, MakeHumanAssets& assets) {
  Result<void> done;
  if (file.path == "base.obj") {
    Result<MakeHumanMesh> base = parse_makehuman_mesh(file.where, file.content);
    base ? void(assets.base = std::move(*base)) : void(done = base.failure());
  } else if (file.path == "weights.default.json") {
    Result<SkinWeights> skin = parse_makehuman_weights(file.where, rig, file.content, joint_from_bone());
    skin ? void(assets.skin = std::move(*skin)) : void(done = skin.failure());
  } else if (file.path.starts_with("targets/")) {
    const std::string name = file.path.substr(8, file.path.size() - 8 - std::string_view(".target.gz").size());
    const Result<std::string> text = gunzip(file.where, file.content, kMaxTargetBytes);
    Result<MakeHumanTarget> target = text ? parse_makehuman_target(file.where, *text) : text.failure();
    target ? void(assets.targets.at(name) = std::move(*target)) : void(done = target.failure());
  }
  return done;
}

}  // namespace

MakeHumanData::MakeHumanData() : impl_(std::make_unique<Impl>()) {}
MakeHumanData::MakeHumanData(MakeHumanData&&) noexcept = default;
MakeHumanData& MakeHumanData::operator=(MakeHumanData&&) noexcept = default;
MakeHumanData::~MakeHumanData() = default;

Result<MakeHumanData> MakeHumanData::load(const std::filesystem::path& directory) {
  Result<MakeHumanAssets> assets = load_makehuman_assets(directory);
  if (!assets) return assets.failure();
  MakeHumanData data;
  data.impl_->assets = std::move(*assets);
  return data;
}

Result<MakeHumanAssets> load_makehuman_assets(const std::filesystem::path& directory) {
  if (std::error_code ignored; !std::filesystem::is_directory(directory, ignored)) {
    return error("{}: no body data; scripts/fetch-body-data fetches it", directory.string());
  }
  const std::vector<std::string> names = target_names();
  std::vector<std::string> paths = {"LICENSE.md", "base.obj", "rig.default.json", "weights.default.json"};
  for (const std::string& name : names) paths.push_back("targets/" + name + ".target.gz");
  std::sort(paths.begin(), paths.end());

  std::vector<std::string> contents(paths.size()), hashes(paths.size()), failures(paths.size());
  parallel_for(paths.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Result<std::string> content = read_text_file(directory / paths[i]);
      if (content) {
        hashes[i] = sha256(*content);
        contents[i] = std::move(*content);
      } else {
        failures[i] = content.error().message;
      }
    }
  });
  std::string list;
  for (size_t i = 0; i < paths.size(); ++i) {
    if (!failures[i].empty()) return error("{} (scripts/fetch-body-data fetches the body data)", failures[i]);
    list += fmt::format("{}  {}\n", hashes[i], paths[i]);
  }
  MakeHumanAssets assets;
  assets.hash = sha256(list);
  if (assets.hash != kListSha256) {
    return error("{}: not the expected body data (SHA-256 of its list is {}); scripts/fetch-body-data fetches it again",
                 directory.string(), assets.hash);
  }

  for (const std::string& name : names) assets.targets[name];  // so that threads find each its own
  const auto rig = std::ranges::lower_bound(paths, std::string("rig.default.json")) - paths.begin();
  parallel_for(paths.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const AssetFile file{(directory / paths[i]).string(), paths[i], contents[i]};
      const Result<void> done = parse_asset(file, contents[static_cast<size_t>(rig)], assets);
      if (!done) failures[i] = done.error().message;
    }
  });
  for (const std::string& failure : failures) {
    if (!failure.empty()) return error("{}", failure);
  }
  return assets;
}

}  // namespace silpose
