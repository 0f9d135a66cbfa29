#include "silpose/exchange/ply.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <string_view>

#include "silpose/base/text_file.h"

namespace silpose {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are read as they lie in memory");

// Bytes of a scalar property by its type's name.
const std::map<std::string, size_t, std::less<>>& scalar_sizes() {
  static const std::map<std::string, size_t, std::less<>> kSizes = {
      {"char", 1},   {"int8", 1},    {"uchar", 1},  {"uint8", 1},  {"short", 2}, {"int16", 2},
      {"ushort", 2}, {"uint16", 2},  {"int", 4},    {"int32", 4},  {"uint", 4},  {"uint32", 4},
      {"float", 4},  {"float32", 4}, {"double", 8}, {"float64", 8}};
  return kSizes;
}

struct VertexLayout {
  int64_t count = -1;                // of vertices
  size_t row_bytes = 0;              // of one vertex
  std::map<char, size_t> offset_of;  // of 'x', 'y' and 'z' in it
  size_t begin = 0;                  // of the first vertex in the file
};

Result<VertexLayout> read_header(std::string_view text, const std::string& file) {
  VertexLayout layout;
  bool is_ply = false, is_little_endian = false, in_vertex = false;
  for (size_t start = 0; start < text.size();) {
    const size_t end = text.find('\n', start);
    if (end == std::string_view::npos) break;
    std::istringstream line{std::string(text.substr(start, end - start))};
    const bool is_first = start == 0;
    start = end + 1;
    std::string word, type, name;
    line >> word;
    if (is_first) is_ply = word == "ply";
    if (!is_ply) break;
    if (word == "format") {
      line >> type >> name;
      is_little_endian = type == "binary_little_endian" && name == "1.0";
    } else if (word == "element") {
      line >> type;
      in_vertex = type == "vertex";
      if (in_vertex && !(line >> layout.count)) return error("{}: the header does not say how many vertices", file);
      if (!in_vertex && layout.count < 0) return error("{}: its first element is '{}', not vertex", file, type);
    } else if (word == "property" && in_vertex) {
      line >> type >> name;
      const auto size = scalar_sizes().find(type);
      if (size == scalar_sizes().end()) return error("{}: a vertex has a property of type '{}'", file, type);
      if (name == "x" || name == "y" || name == "z") {
        if (type != "float" && type != "float32") return error("{}: {} is of type {}, not float", file, name, type);
        layout.offset_of[name[0]] = layout.row_bytes;
      }
      layout.row_bytes += size->second;
    } else if (word == "end_header") {
      layout.begin = start;
      break;
    }
  }
  if (!is_ply || layout.begin == 0) return error("{}: no PLY file", file);
  if (!is_little_endian) return error("{}: a PLY file, but not of binary_little_endian 1.0", file);
  if (layout.count < 0 || layout.offset_of.size() != 3) return error("{}: no vertices with x, y and z", file);
  return layout;
}

}  // namespace

Result<std::vector<Eigen::Vector3f>> read_ply_vertices(const std::filesystem::path& path) {
  const std::string file = path.string();
  const Result<std::string> bytes = read_text_file(path);
  if (!bytes) return bytes.failure();
  const Result<VertexLayout> layout = read_header(*bytes, file);
  if (!layout) return layout.failure();
  const auto count = static_cast<size_t>(layout->count);
  if ((bytes->size() - layout->begin) / layout->row_bytes < count) {
    return error("{}: ends before its {} vertices do", file, count);
  }
  std::vector<Eigen::Vector3f> vertices(count);
  for (size_t v = 0; v < count; ++v) {
    const char* const row = bytes->data() + layout->begin + v * layout->row_bytes;
    for (int axis = 0; axis < 3; ++axis) {
      std::memcpy(&vertices[v][axis], row + layout->offset_of.at("xyz"[axis]), sizeof(float));
    }
    if (!vertices[v].allFinite()) return error("{}: vertex {} is not finite", file, v);
  }
  return vertices;
}

}  // namespace silpose
