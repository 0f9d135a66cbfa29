#include "silpose/image/image_list.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <utility>

namespace silpose {
namespace {

namespace fs = std::filesystem;

Result<std::vector<fs::path>> files_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored) && entry->path().filename().string()[0] != '.') paths.push_back(entry->path());
  }
  if (code) return error("{}: cannot be listed ({})", folder.string(), code.message());
  std::sort(paths.begin(), paths.end());
  return paths;
}

// Larger numbers at the end of a name are a date or a clock rather than a count.
constexpr int64_t kLargestNumber = 99'999'999;

// "walk_000030.png" is "walk_" and 30.
std::optional<std::pair<std::string, int64_t>> split_name(const fs::path& path) {
  const std::string stem = path.stem().string();
  const size_t digits = stem.find_last_not_of("0123456789") + 1;
  int64_t number = 0;
  const auto [end, failure] = std::from_chars(stem.data() + digits, stem.data() + stem.size(), number);
  if (digits == stem.size() || failure != std::errc() || number > kLargestNumber) return {};
  return std::pair(stem.substr(0, digits), number);
}

// The numbers of names that are one text and a number each; nothing where any is not.
std::vector<int64_t> numbers_of(const std::vector<fs::path>& paths) {
  std::vector<int64_t> numbers;
  std::string text;
  for (const fs::path& path : paths) {
    const auto name = split_name(path);
    if (!name || (!numbers.empty() && name->first != text)) return {};
    text = name->first;
    numbers.push_back(name->second);
  }
  return numbers;
}

// In the order of their numbers where all have one, of their names otherwise.
Result<ImageList> images_in(const fs::path& folder) {
  Result<std::vector<fs::path>> paths = files_in(folder);
  if (!paths) return paths.failure();
  std::erase_if(*paths, [](const fs::path& path) { return !is_image_name(path); });
  if (paths->empty()) return error("{}: no images in this directory", folder.string());
  const auto number = [](const fs::path& path) { return split_name(path)->second; };
  if (!numbers_of(*paths).empty()) std::ranges::stable_sort(*paths, {}, number);
  ImageList images{.paths = std::move(*paths)};
  images.numbers = numbers_of(images.paths);
  const auto twice = std::ranges::adjacent_find(images.numbers);
  if (twice != images.numbers.end()) {
    const auto at = static_cast<size_t>(twice - images.numbers.begin());
    return error("{}: {} and {} have the same number", folder.string(), images.paths[at].filename().string(),
                 images.paths[at + 1].filename().string());
  }
  return images;
}

// The pieces of "name-%06d.png".
struct Pattern {
  std::string before, after;
  size_t min_digits = 1;
};

std::optional<Pattern> parse_pattern(const std::string& name) {
  const size_t percent = name.find('%');
  if (percent == std::string::npos) return {};
  const size_t end = name.find_first_not_of("0123456789", percent + 1);
  if (end == std::string::npos || name[end] != 'd') return {};
  Pattern pattern{.before = name.substr(0, percent), .after = name.substr(end + 1)};
  std::from_chars(name.data() + percent + 1, name.data() + end, pattern.min_digits);
  if (pattern.after.find('%') != std::string::npos || pattern.min_digits > 18) return {};
  return pattern;
}

// In the order of their numbers, which must follow one another.
Result<ImageList> images_of_pattern(const fs::path& input, const Pattern& pattern) {
  const fs::path folder = input.has_parent_path() ? input.parent_path() : fs::path(".");
  const Result<std::vector<fs::path>> files = files_in(folder);
  if (!files) return files.failure();
  std::vector<std::pair<int64_t, fs::path>> numbered;
  for (const fs::path& path : *files) {
    const std::string name = path.filename().string();
    if (name.size() <= pattern.before.size() + pattern.after.size() || !name.starts_with(pattern.before) ||
        !name.ends_with(pattern.after)) {
      continue;
    }
    const char *first = name.data() + pattern.before.size(), *last = name.data() + name.size() - pattern.after.size();
    int64_t number = 0;
    const auto [stop, failure] = std::from_chars(first, last, number);
    const size_t digits = static_cast<size_t>(last - first);
    if (failure != std::errc() || stop != last || number < 0 || *first == '-') continue;
    if (digits < pattern.min_digits || (digits > std::max<size_t>(pattern.min_digits, 1) && *first == '0')) continue;
    numbered.emplace_back(number, path);
  }
  if (numbered.empty()) return error("{}: no image has such a name", input.string());
  std::sort(numbered.begin(), numbered.end());
  ImageList images;
  for (const auto& [number, path] : numbered) {
    const int64_t expected = numbered.front().first + std::ssize(images.paths);
    if (number != expected) return error("{}: image number {} is missing", input.string(), expected);
    images.paths.push_back(path);
    images.numbers.push_back(number);
  }
  if (images.numbers.back() > kLargestNumber) images.numbers.clear();
  return images;
}

}  // namespace

bool is_image_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::string kImages[] = {".png",  ".jpg", ".jpeg", ".bmp", ".tif", ".tiff",
                                        ".webp", ".ppm", ".pgm",  ".jp2", ".pbm"};
  return std::find(std::begin(kImages), std::end(kImages), extension) != std::end(kImages);
}

Result<ImageList> list_images(const std::string& input) {
  const fs::path path(input);
  std::error_code code;
  if (fs::is_directory(path, code)) return images_in(path);
  if (fs::exists(path, code)) return ImageList{.paths = {path}};
  if (const auto pattern = parse_pattern(path.filename().string())) return images_of_pattern(path, *pattern);
  return error("{}: no such file or directory", input);
}

}  // namespace silpose
