#include "source_rules.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <functional>
#include <regex>
#include <set>
#include <sstream>

namespace silpose {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRecording = "recording";  // the lowest module of silpose that sees sadb

// Calls visit(path from the root, line number, line) for every line of every file under the folder that has one of the
// extensions, in name order.
void for_each_line(const fs::path& root, const fs::path& folder,
                   const std::function<void(const fs::path&, int, const std::string&)>& visit,
                   const std::set<std::string>& extensions = {".h", ".cc"}) {
  if (!fs::is_directory(root / folder)) return;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    if (entry.is_regular_file() && extensions.contains(entry.path().extension().string())) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    std::ifstream stream(file);
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) visit(file.lexically_relative(root), number, line);
  }
}

std::string at(const fs::path& file, int line, const std::string& what) {
  return file.generic_string() + ":" + std::to_string(line) + ": " + what;
}

// "src/silpose/geometry/camera.h" -> {"silpose", "geometry"}; empty where a path is not of a module.
struct Place {
  std::string project, module;
};
Place place_of(const fs::path& path_in_src) {
  std::vector<std::string> parts;
  for (const fs::path& part : path_in_src) parts.push_back(part.string());
  if (parts.size() < 3) return {parts.empty() ? "" : parts[0], ""};
  return {parts[0], parts[1]};
}

// Why `from` may not include `to`; empty where it may.
std::string refusal(const Place& from, const Place& to, bool is_test, const Floors& floors) {
  if (from.project == to.project && from.module == to.module) return "";
  const auto own = floors.find(from.module), other = floors.find(to.module);
  if (own == floors.end()) return "module '" + from.module + "' has no floor in cmake/modules.cmake";
  if (other == floors.end()) return "module '" + to.module + "' has no floor in cmake/modules.cmake";
  if (is_test && (to.module == "synth" || to.module == "human")) return "";
  if (other->second >= own->second) {
    return from.module + " (floor " + std::to_string(own->second) + ") includes " + to.module + " (floor " +
           std::to_string(other->second) + ")";
  }
  if (from.project == "sadb" && to.project == "silpose" && to.module != "base" && to.module != "geometry" &&
      to.module != "image") {
    return "sadb sees only base, geometry and image of silpose, not " + to.module;
  }
  const auto recording = floors.find(kRecording);
  if (from.project == "silpose" && to.project == "sadb" && recording != floors.end() &&
      own->second < recording->second) {
    return from.module + " is below recording and does not see sadb";
  }
  return "";
}

// "src/silpose/track/limbs.cc" -> {"src/silpose/track", "limbs"}; empty where a file is of no module.
struct Unit {
  std::string module, name;
};
Unit unit_of(const fs::path& file) {
  static const std::regex kUnit(R"(((?:src/(?:silpose|sadb)/[^/]+|apps/silpose|bench))/(.+?)(?:-inl)?\.(?:h|cc))");
  const std::string path = file.generic_string();
  std::smatch match;
  if (!std::regex_match(path, match, kUnit)) return {};
  return {match[1], match[2]};
}

// The file that an #include line names, relative to the root; empty where it is not of the tree.
fs::path included_file(const fs::path& root, const fs::path& from, const std::string& name) {
  for (const fs::path& folder : {from.parent_path(), fs::path("src"), fs::path()}) {
    const fs::path file = (folder / name).lexically_normal();
    if (fs::is_regular_file(root / file)) return file;
  }
  return {};
}

using Dependencies = std::map<std::string, std::set<std::string>>;  // unit -> units that it includes

// Each unit that is reached from `start`, itself only by a circle; with the one before it on a shortest way.
std::map<std::string, std::string> reached_from(const std::string& start, const Dependencies& dependencies) {
  std::map<std::string, std::string> before;
  std::vector<std::string> found = {start};
  for (size_t i = 0; i < found.size(); ++i) {
    const std::string unit = found[i];
    const auto included = dependencies.find(unit);
    if (included == dependencies.end()) continue;
    for (const std::string& next : included->second) {
      if (before.emplace(next, unit).second) found.push_back(next);
    }
  }
  return before;
}

std::set<std::string> bibliography_keys(const fs::path& file) {
  static const std::regex kEntry(R"(^\s*@\w+\s*\{\s*([^,\s]+)\s*,)");
  std::set<std::string> keys;
  std::ifstream stream(file);
  std::string line;
  for (std::smatch match; std::getline(stream, line);) {
    if (std::regex_search(line, match, kEntry)) keys.insert(match[1]);
  }
  return keys;
}

// Keys a comment cites. A list after "references.bib:" runs to the closing bracket or the line's end; of each item the
// first word is the key ("deutscher2005; deutscher2000 for the decay").
std::set<std::string> cited_keys(const std::string& comment) {
  static const std::regex kKey(R"(\b[a-z]{2,}(19|20)[0-9]{2}[a-z]?\b)"), kList(R"(references\.bib:([^)]*))"),
      kItem(R"(\s*([A-Za-z0-9_-]+)[^,;]*[,;]?)");
  std::set<std::string> keys;
  for (std::sregex_iterator it(comment.begin(), comment.end(), kKey), end; it != end; ++it) keys.insert(it->str());
  for (std::sregex_iterator it(comment.begin(), comment.end(), kList), end; it != end; ++it) {
    const std::string list = (*it)[1];
    for (std::sregex_iterator item(list.begin(), list.end(), kItem); item != end; ++item) keys.insert((*item)[1]);
  }
  return keys;
}

// The tags of a comment (its lines joined by spaces) that are wrong, each with why; `is_tagged` where a right one is
// found.
std::vector<std::string> wrong_tags(const std::string& comment, const fs::path& root, const std::set<std::string>& keys,
                                    bool& is_tagged) {
  static const std::regex kTag(
      R"(\[(?:(guess|definition|tuned on [^\]]*[^\]\s][^\]]*)|(paper|measured): *([^\]]*))\])");
  static const std::regex kExperiment(R"(experiment ([A-Za-z0-9_-]+))");
  std::vector<std::string> wrong;
  for (std::sregex_iterator it(comment.begin(), comment.end(), kTag), end; it != end; ++it) {
    is_tagged = true;
    const std::string kind = (*it)[2], source = (*it)[3];
    std::smatch match;
    if (kind == "paper" && !keys.contains(source)) wrong.push_back("'" + source + "' is not in docs/references.bib");
    if (kind != "measured") continue;
    if (!std::regex_match(source, match, kExperiment)) {
      wrong.push_back("'[measured: " + source + "]' does not name an experiment");
    } else if (!fs::is_regular_file(root / "experiments" / (match[1].str() + ".toml"))) {
      wrong.push_back("there is no experiments/" + match[1].str() + ".toml");
    }
  }
  return wrong;
}

// Looks at one file, line by line; `report` is called with a line number and what is wrong there.
class ProvenanceScan {
 public:
  using Report = std::function<void(int, const std::string&)>;
  using Check = std::function<bool(int, const std::string&)>;  // reports wrong tags; whether a comment has any tag

  ProvenanceScan(Check check, Report report) : check_(std::move(check)), report_(std::move(report)) {}

  void add(int number, const std::string& line) {
    static const std::regex kConstant(R"(^(?:inline |static )*constexpr\b.*?\b(k[A-Z]\w*)\s*(?:\[[^\]]*\])?\s*[={])");
    static const std::regex kString(R"("(?:[^"\\]|\\.)*")");
    const std::string text = std::regex_replace(line, kString, "\"\"");
    const size_t slashes = text.find("//");
    const std::string code = text.substr(0, slashes);
    const std::string comment = slashes == std::string::npos ? "" : text.substr(slashes + 2);
    const bool is_blank = code.find_first_not_of(" \t") == std::string::npos;
    if (is_blank && !comment.empty()) {
      if (!in_comment_) group_.clear();
      group_ += " " + comment;
    }
    in_comment_ = is_blank && !comment.empty();
    if (is_blank && comment.empty()) group_.clear();
    if (is_blank) return;
    std::smatch match;
    if (name_.empty() && std::regex_search(code, match, kConstant)) {
      name_ = match[1];
      begin_ = number;
      initialiser_ = own_ = "";
      initialiser_ += code.substr(static_cast<size_t>(match.position(0) + match.length(0)));
    } else if (!name_.empty()) {
      initialiser_ += " " + code;
    }
    if (name_.empty()) return;
    own_ += " " + comment;
    if (code.find(';') != std::string::npos) finish();
  }

 private:
  void finish() {
    static const std::regex kNumber(R"((^|[^\w])\.?[0-9])");
    const bool has_number = std::regex_search(initialiser_, kNumber);
    const bool own = check_(begin_, own_), group = check_(begin_, group_);
    if (has_number && !own && !group) {
      report_(begin_, name_ +
                          " does not say where it comes from: [paper: KEY], [measured: experiment NAME], "
                          "[tuned on WHAT], [guess] or [definition]");
    }
    name_.clear();
  }

  Check check_;
  Report report_;
  std::string group_;  // comment above the group that is read
  bool in_comment_ = false;
  std::string name_, initialiser_, own_;  // of the constant that is read; its name is empty outside of one
  int begin_ = 0;
};

}  // namespace

Floors parse_floors(std::string_view text) {
  Floors floors;
  std::istringstream stream{std::string(text)};
  for (std::string entry; stream >> entry;) {
    const size_t equals = entry.find('=');
    if (equals != std::string::npos) floors[entry.substr(0, equals)] = std::stoi(entry.substr(equals + 1));
  }
  return floors;
}

std::vector<std::string> include_violations(const fs::path& root, const Floors& floors) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*["<]((silpose|sadb)/[^">]+)[">])");
  std::vector<std::string> violations;
  for_each_line(root, "src", [&](const fs::path& file, int number, const std::string& line) {
    std::smatch match;
    if (!std::regex_search(line, match, kInclude)) return;
    const fs::path included = match[1].str();
    const Place from = place_of(file.lexically_relative("src"));
    if (from.module.empty()) return;  // the umbrella header is above all modules
    const bool is_test = file.stem().string().ends_with("_test");
    const std::string reason = refusal(from, place_of(included), is_test, floors);
    if (!reason.empty()) violations.push_back(at(file, number, reason));
  });
  return violations;
}

std::vector<std::string> unit_circles(const fs::path& root) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*["<]([^">]+)[">])");
  std::map<std::string, Dependencies> modules;
  for (const char* top : {"src", "apps", "bench"}) {
    for_each_line(root, top, [&](const fs::path& file, int, const std::string& line) {
      std::smatch match;
      if (file.stem().string().ends_with("_test") || !std::regex_search(line, match, kInclude)) return;
      const Unit from = unit_of(file), to = unit_of(included_file(root, file, match[1]));
      if (from.module.empty() || from.module != to.module || from.name == to.name) return;
      modules[from.module][from.name].insert(to.name);
    });
  }
  std::vector<std::string> circles;
  for (const auto& [module, dependencies] : modules) {
    std::set<std::string> reported;
    for (const auto& [unit, included] : dependencies) {
      const auto before = reached_from(unit, dependencies);
      if (reported.contains(unit) || !before.contains(unit)) continue;
      std::string circle = unit;
      for (std::string last = before.at(unit);; last = before.at(last)) {
        circle.insert(0, last + " -> ");
        if (last == unit) break;
      }
      circles.push_back(module + ": " + circle);
      for (const auto& [other, previous] : before) {
        if (reached_from(other, dependencies).contains(unit)) reported.insert(other);
      }
    }
  }
  return circles;
}

std::vector<std::string> folder_violations(const fs::path& root) {
  static const std::set<std::string> kRefused = {"util", "utils",  "utility", "common",
                                                 "core", "helper", "helpers", "misc"};
  std::vector<std::string> violations;
  for (const char* top : {"src", "apps", "bench", "examples", "tests"}) {
    if (!fs::is_directory(root / top)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      if (entry.is_directory() && kRefused.contains(entry.path().filename().string())) {
        violations.push_back(entry.path().lexically_relative(root).generic_string() + ": a name that says nothing");
      }
    }
  }
  std::sort(violations.begin(), violations.end());
  return violations;
}

std::vector<std::string> citation_violations(const fs::path& root) {
  const std::set<std::string> known = bibliography_keys(root / "docs" / "references.bib");
  std::vector<std::string> violations;
  for (const char* top : {"src", "apps", "bench", "examples"}) {
    for_each_line(root, top, [&](const fs::path& file, int number, const std::string& line) {
      const size_t comment = line.find("//");
      if (comment == std::string::npos) return;
      for (const std::string& key : cited_keys(line.substr(comment))) {
        if (!known.contains(key)) violations.push_back(at(file, number, "'" + key + "' is not in docs/references.bib"));
      }
    });
  }
  return violations;
}

std::vector<std::string> provenance_violations(const fs::path& root, const std::vector<std::string>& folders) {
  const std::set<std::string> keys = bibliography_keys(root / "docs" / "references.bib");
  std::vector<std::string> violations;
  for (const std::string& folder : folders) {
    if (!fs::is_directory(root / folder)) {
      violations.push_back(folder + ": there is no such folder");
      continue;
    }
    fs::path current;
    const auto report = [&](int number, const std::string& what) { violations.push_back(at(current, number, what)); };
    const auto check = [&](int number, const std::string& comment) {
      bool is_tagged = false;
      for (const std::string& wrong : wrong_tags(comment, root, keys, is_tagged)) report(number, wrong);
      return is_tagged;
    };
    ProvenanceScan scan(check, report);
    for_each_line(root, folder, [&](const fs::path& file, int number, const std::string& line) {
      const std::string stem = file.stem().string();
      if (stem.ends_with("_test") || stem.ends_with("_for_test")) return;
      if (file != current) scan = ProvenanceScan(check, report);
      current = file;
      scan.add(number, line);
    });
  }
  return violations;
}

std::vector<std::string> wording_violations(const fs::path& root, const Phrases& phrases) {
  const auto is_letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  std::vector<std::string> violations;
  const auto visit = [&](const fs::path& file, int number, const std::string& line) {
    if (file.generic_string().starts_with("tests/layering/")) return;
    std::string lower = line;
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const auto& [phrase, better] : phrases) {
      const size_t at_char = lower.find(phrase), end = at_char + phrase.size();
      if (at_char == std::string::npos) continue;
      if ((at_char > 0 && is_letter(lower[at_char - 1])) || (end < lower.size() && is_letter(lower[end]))) continue;
      violations.push_back(at(file, number, "'" + phrase + "': write: " + better));
    }
  };
  const std::set<std::string> extensions = {".h", ".cc", ".md", ".toml", ".sh", "", ".js", ".py"};
  for (const char* top : {"src", "apps", "bench", "examples", "scripts", "docs", "experiments", "tests"}) {
    for_each_line(root, top, visit, extensions);
  }
  for (const char* name : {"README.md", "ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md"}) {
    std::ifstream stream(root / name);
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) visit(name, number, line);
  }
  return violations;
}

}  // namespace silpose
