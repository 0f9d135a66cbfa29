// Names are cut into a side and a plain word, and looked up.
#include "silpose/mocap/retarget_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>

namespace silpose {
namespace {

enum class Side { kNone, kLeft, kRight };

struct PlainName {
  Side side = Side::kNone;
  std::string word;  // lower case letters and digits
};

bool is_separator(char c) { return c == '_' || c == '.' || c == '-' || c == ' '; }

std::string to_lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return out;
}

Side side_of_token(const std::string& token) {
  if (token == "l" || token == "left") return Side::kLeft;
  if (token == "r" || token == "right") return Side::kRight;
  return Side::kNone;
}

// "mixamorig:LeftUpLeg", "upperleg01.L", "LHipJoint", "Bip01 L Thigh" -> {kLeft, "upleg" | "upperleg01" | ...}.
PlainName plain_name(std::string_view name) {
  PlainName plain;
  if (name.starts_with("__")) return plain;  // MakeHuman's connecting bones
  if (const size_t colon = name.rfind(':'); colon != std::string_view::npos) name.remove_prefix(colon + 1);
  if (to_lower(name).starts_with("mixamorig")) name.remove_prefix(9);

  std::vector<std::string> tokens(1);
  for (const char c : name) {
    if (is_separator(c)) {
      tokens.emplace_back();
    } else {
      tokens.back() += c;
    }
  }
  std::erase_if(tokens, [](const std::string& token) { return token.empty() || to_lower(token).starts_with("bip0"); });
  for (size_t i = 0; i < tokens.size() && plain.side == Side::kNone; ++i) {
    plain.side = side_of_token(to_lower(tokens[i]));
    if (plain.side != Side::kNone) tokens.erase(tokens.begin() + static_cast<std::ptrdiff_t>(i));
  }
  std::string joined;
  for (const std::string& token : tokens) joined += token;
  if (plain.side == Side::kNone) {
    const std::string lower = to_lower(joined);
    const bool one_letter = joined.size() > 1 && std::isupper(static_cast<unsigned char>(joined[1]));
    if (lower.starts_with("left") || (one_letter && lower[0] == 'l')) {
      plain.side = Side::kLeft;
    } else if (lower.starts_with("right") || (one_letter && lower[0] == 'r')) {
      plain.side = Side::kRight;
    }
    if (plain.side != Side::kNone) {
      const bool whole = lower.starts_with("left") || lower.starts_with("right");
      joined.erase(0, whole ? (plain.side == Side::kLeft ? 4 : 5) : 1);
    }
  }
  plain.word = to_lower(joined);
  return plain;
}

// Words for each part, the most specific first: "hip" and "shoulder" name the limb's joint only where nothing better
// does.
struct Aliases {
  std::string_view part;
  std::initializer_list<std::string_view> words;
};
const std::array<Aliases, 11> kAliases{{
    {"root", {"hips", "pelvis", "hip", "root"}},
    {"neck", {"neck", "neck01", "neck1", "lowerneck"}},
    {"head", {"head", "skull"}},
    {"thigh", {"upleg", "upperleg", "upperleg01", "thigh", "femur", "hip"}},
    {"shin", {"leg", "loleg", "lowleg", "lowerleg", "lowerleg01", "shin", "calf", "tibia", "knee"}},
    {"foot", {"foot", "ankle"}},
    {"toe", {"toebase", "toe", "toes", "ball", "toe11", "footend"}},
    {"upper_arm", {"arm", "uparm", "upperarm", "upperarm01", "humerus", "shldr", "shoulder"}},
    {"forearm", {"forearm", "loarm", "lowarm", "lowerarm", "lowerarm01", "radius", "elbow"}},
    {"hand", {"hand", "wrist"}},
    {"finger", {"handmiddle1", "middle1", "finger31", "handindex1", "index1", "handend", "fingers"}},
}};

}  // namespace

std::optional<int> find_part(const std::vector<std::string>& names, std::string_view part) {
  Side side = Side::kNone;
  if (part.starts_with("left_")) side = Side::kLeft, part.remove_prefix(5);
  if (part.starts_with("right_")) side = Side::kRight, part.remove_prefix(6);
  const auto aliases = std::find_if(kAliases.begin(), kAliases.end(), [&](const Aliases& a) { return a.part == part; });
  if (aliases == kAliases.end()) return std::nullopt;
  std::vector<PlainName> plain;
  plain.reserve(names.size());
  for (const std::string& name : names) plain.push_back(plain_name(name));
  for (const std::string_view word : aliases->words) {
    for (size_t i = 0; i < plain.size(); ++i) {
      if (plain[i].side == side && plain[i].word == word) return static_cast<int>(i);
    }
  }
  return std::nullopt;
}

}  // namespace silpose
