#include "length_rules.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <set>

namespace silpose {
namespace {

namespace fs = std::filesystem;

constexpr size_t kDeepest = 4;  // indentation of a member function of a nested class

size_t indentation(const std::string& line) { return std::min(line.find_first_not_of(' '), line.size()); }

// Whether a statement goes on in the next line.
bool continues(const std::string& line) {
  const size_t begin = line.find_first_not_of(' '), end = line.find_last_not_of(' ');
  if (begin == std::string::npos || line[begin] == '#' || line.compare(begin, 2, "//") == 0) return false;
  return line.ends_with("::") || std::string_view(";{}:").find(line[end]) == std::string_view::npos;
}

// The line in which the statement begins whose last line is `last`.
size_t head_of(const std::vector<std::string>& lines, size_t last) {
  while (last > 0 && continues(lines[last - 1])) --last;
  return last;
}

// Whether a statement that opens a block is the head of a function.
bool is_function_head(const std::string& statement) {
  static const std::regex kOther(
      R"(^ *(?:(?:namespace|struct|class|enum|union|if|for|while|switch|do|else|case|return|try|catch)\b|\}).*)");
  return statement.find('(') != std::string::npos && !std::regex_match(statement, kOther);
}

// Calls visit(first line, number of lines) for each function.
template <class Visit>
void for_each_function(const std::vector<std::string>& lines, const Visit& visit) {
  for (size_t i = 0; i < lines.size(); ++i) {
    if (!lines[i].ends_with('{')) continue;
    const size_t head = head_of(lines, i), indent = indentation(lines[head]);
    std::string statement;
    for (size_t k = head; k <= i; ++k) statement += lines[k];
    if (indent > kDeepest || !is_function_head(statement)) continue;
    const std::string brace = std::string(indent, ' ') + "}";
    size_t end = i + 1;
    while (end < lines.size() && !lines[end].starts_with(brace)) ++end;
    visit(head, end - head + 1);
  }
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

std::vector<std::string> length_violations(const fs::path& root, const std::vector<std::string>& folders,
                                           const LengthLimits& limits) {
  std::set<fs::path> files;
  for (const std::string& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension().string();
      if (entry.is_regular_file() && (extension == ".h" || extension == ".cc")) files.insert(entry.path());
    }
  }
  std::vector<std::string> violations;
  for (const fs::path& file : files) {
    const std::vector<std::string> lines = lines_of(file);
    const std::string name = file.lexically_relative(root).generic_string();
    const auto report = [&](const std::string& where, size_t count, const std::string& what, size_t most) {
      if (count <= most) return;
      violations.push_back(name + where + ": " + std::to_string(count) + " lines" + what + ", at most " +
                           std::to_string(most));
    };
    report("", lines.size(), "", limits.file);
    for_each_function(lines, [&](size_t head, size_t count) {
      report(":" + std::to_string(head + 1), count, " of '" + lines[head].substr(indentation(lines[head])) + "'",
             limits.function);
    });
  }
  return violations;
}

}  // namespace silpose
