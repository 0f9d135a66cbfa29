#include "silpose/segment/tflite_file.h"

#include <flatbuffers/flatbuffers.h>
#include <opencv2/core/cvdef.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <optional>

namespace silpose {
namespace {

// [guess] Larger files, tensors and steps are refused as damaged.
constexpr size_t kMaxFileBytes = size_t{1} << 30;
constexpr int64_t kMaxElements = int64_t{1} << 26;  // of one tensor, and of all constants together
constexpr int kMaxSize = 1 << 20;                   // of one axis
constexpr int kMaxStep = 1024;                      // strides, dilations etc.
enum TensorType { kFloat32 = 0, kFloat16 = 1, kInt32 = 2 };

// A table of the file. What lies outside of the file reads as absent, and is remembered in `broken`.
class Node {
 public:
  struct File {
    flatbuffers::Verifier verifier;
    bool broken = false;
  };

  static std::optional<Node> at(File& file, const flatbuffers::Table* table) {
    if (!table->VerifyTableStart(file.verifier)) {
      file.broken = true;
      return std::nullopt;
    }
    file.verifier.EndTable();  // depth is no concern: nothing here recurses
    return Node(file, table);
  }

  template <class T>
  [[nodiscard]] T scalar(int slot, T fallback) const {
    if (!believe(table_->VerifyField<T>(file_->verifier, field(slot), sizeof(T)))) return fallback;
    return table_->GetField<T>(field(slot), fallback);
  }

  [[nodiscard]] std::optional<Node> child(int slot) const {
    if (!has(slot) || !believe(table_->VerifyOffset(file_->verifier, field(slot)))) return std::nullopt;
    return at(*file_, table_->GetPointer<const flatbuffers::Table*>(field(slot)));
  }

  // Absent: null.
  template <class T>
  [[nodiscard]] const flatbuffers::Vector<T>* vector(int slot) const {
    if (!has(slot) || !believe(table_->VerifyOffset(file_->verifier, field(slot)))) return nullptr;
    const auto* found = table_->GetPointer<const flatbuffers::Vector<T>*>(field(slot));
    return believe(file_->verifier.VerifyVector(found)) ? found : nullptr;
  }

  template <class T>
  [[nodiscard]] std::vector<int> integers(int slot) const {
    std::vector<int> values;
    if (const auto* found = vector<T>(slot)) {
      values.reserve(found->size());
      for (flatbuffers::uoffset_t i = 0; i < found->size(); ++i) values.push_back(static_cast<int>(found->Get(i)));
    }
    return values;
  }

  [[nodiscard]] std::string text(int slot) const {
    const auto* found = vector<uint8_t>(slot);
    return found ? std::string(reinterpret_cast<const char*>(found->Data()), found->size()) : "";
  }

  [[nodiscard]] std::vector<Node> children(int slot) const {
    std::vector<Node> nodes;
    const auto* offsets = vector<flatbuffers::uoffset_t>(slot);
    if (offsets == nullptr) return nodes;
    for (flatbuffers::uoffset_t i = 0; i < offsets->size(); ++i) {
      const uint8_t* place = offsets->Data() + i * sizeof(flatbuffers::uoffset_t);
      const size_t offset = file_->verifier.VerifyOffset(place, 0);
      if (!believe(offset != 0)) return {};
      const auto node = at(*file_, reinterpret_cast<const flatbuffers::Table*>(place + offset));
      if (!node) return {};
      nodes.push_back(*node);
    }
    return nodes;
  }

  [[nodiscard]] bool has(int slot) const { return table_->CheckField(field(slot)); }

 private:
  Node(File& file, const flatbuffers::Table* table) : file_(&file), table_(table) {}
  static flatbuffers::voffset_t field(int slot) { return static_cast<flatbuffers::voffset_t>(4 + 2 * slot); }
  bool believe(bool is_sound) const {
    file_->broken = file_->broken || !is_sound;
    return is_sound;
  }
  File* file_;
  const flatbuffers::Table* table_;
};

// The number of elements; nothing where the shape cannot be.
std::optional<int64_t> volume(const std::vector<int>& shape) {
  int64_t count = 1;
  for (const int size : shape) {
    if (size < 1 || size > kMaxSize) return std::nullopt;
    count *= size;
    if (count > kMaxElements) return std::nullopt;
  }
  return count;
}

template <class T>
std::vector<T> as_numbers(const flatbuffers::Vector<uint8_t>& bytes) {
  static_assert(std::endian::native == std::endian::little);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::copy_n(bytes.Data(), values.size() * sizeof(T), reinterpret_cast<uint8_t*>(values.data()));
  return values;
}

std::vector<int> sparse_indices(const Node& dimension, int type_slot) {
  const auto indices = dimension.child(type_slot + 1);
  if (!indices) return {};
  switch (dimension.scalar<uint8_t>(type_slot, 0)) {
    case 1:
      return indices->integers<int32_t>(0);
    case 2:
      return indices->integers<uint16_t>(0);
    case 3:
      return indices->integers<uint8_t>(0);
    default:
      return {};
  }
}

// Rows of the last axis hold only what is not zero. False where the file holds another kind of sparsity.
bool spell_out(const Node& sparsity, const std::vector<int>& shape, std::vector<float>& values) {
  const std::vector<int> order = sparsity.integers<int32_t>(0);
  const std::vector<Node> dimensions = sparsity.children(2);
  if (!sparsity.integers<int32_t>(1).empty() || shape.empty() || order.size() != shape.size() ||
      dimensions.size() != shape.size()) {
    return false;
  }
  for (size_t i = 0; i < shape.size(); ++i) {
    const bool is_sparse = dimensions[i].scalar<int8_t>(0, 0) == 1;
    if (order[i] != static_cast<int>(i) || is_sparse != (i + 1 == shape.size())) return false;
    if (!is_sparse && dimensions[i].scalar<int32_t>(1, 0) != shape[i]) return false;
  }
  const std::vector<int> starts = sparse_indices(dimensions.back(), 2), columns = sparse_indices(dimensions.back(), 4);
  const auto row_size = static_cast<size_t>(shape.back());
  const size_t rows = static_cast<size_t>(*volume(shape)) / row_size;
  if (starts.size() != rows + 1 || columns.size() != values.size() || starts.front() != 0 ||
      starts.back() != static_cast<int>(values.size()) || !std::is_sorted(starts.begin(), starts.end())) {
    return false;
  }
  std::vector<float> dense(rows * row_size, 0.0f);
  for (size_t row = 0; row < rows; ++row) {
    for (auto i = static_cast<size_t>(starts[row]); i < static_cast<size_t>(starts[row + 1]); ++i) {
      if (columns[i] < 0 || columns[i] >= shape.back()) return false;
      dense[row * row_size + static_cast<size_t>(columns[i])] = values[i];
    }
  }
  values = std::move(dense);
  return true;
}

Result<TfliteTensor> read_tensor(const Node& node, const std::vector<Node>& buffers) {
  TfliteTensor tensor;
  tensor.name = node.text(3);
  tensor.shape = node.integers<int32_t>(0);
  const std::optional<int64_t> count = volume(tensor.shape);
  if (!count) return error("tensor '{}' has an impossible shape", tensor.name);
  const auto type = node.scalar<int8_t>(1, 0);
  const auto buffer = node.scalar<uint32_t>(2, 0);
  if (buffer >= buffers.size()) return error("tensor '{}' has no buffer", tensor.name);
  const auto* bytes = buffers[buffer].vector<uint8_t>(0);
  if (bytes == nullptr || bytes->size() == 0) return tensor;
  if (type == kFloat32) {
    tensor.floats = as_numbers<float>(*bytes);
  } else if (type == kFloat16) {
    const std::vector<uint16_t> halves = as_numbers<uint16_t>(*bytes);
    tensor.floats.reserve(halves.size());
    for (const uint16_t half : halves) tensor.floats.push_back(static_cast<float>(std::bit_cast<cv::float16_t>(half)));
  } else if (type == kInt32) {
    tensor.ints = as_numbers<int32_t>(*bytes);
  } else {
    return error("constant '{}' is of type {}; known are 32- and 16-bit floats and 32-bit integers", tensor.name, type);
  }
  if (const auto sparsity = node.child(6)) {
    if (type == kInt32 || !spell_out(*sparsity, tensor.shape, tensor.floats)) {
      return error("constant '{}' is sparse in a way that is not known", tensor.name);
    }
  }
  if (static_cast<int64_t>(tensor.floats.size() + tensor.ints.size()) != *count) {
    return error("constant '{}' has {} values, its shape {}", tensor.name, tensor.floats.size() + tensor.ints.size(),
                 *count);
  }
  return tensor;
}

bool read_options(const Node& options, TfliteOperator& op) {
  const auto activation = [&](int slot) {
    const auto number = options.scalar<int8_t>(slot, 0);
    op.activation = static_cast<TfliteActivation>(number);
    return number == 0 || number == 1 || number == 3;
  };
  const auto is_step = [](int step) { return step > 0 && step <= kMaxStep; };
  const auto window = [&] {
    const auto padding = options.scalar<int8_t>(0, 0);
    op.same_padding = padding == 0;
    op.stride_x = options.scalar<int32_t>(1, 0);
    op.stride_y = options.scalar<int32_t>(2, 0);
    return (padding == 0 || padding == 1) && is_step(op.stride_x) && is_step(op.stride_y);
  };
  const auto dilation = [&](int slot) {
    op.dilation_x = options.scalar<int32_t>(slot, 1);
    op.dilation_y = options.scalar<int32_t>(slot + 1, 1);
    return is_step(op.dilation_x) && is_step(op.dilation_y);
  };
  switch (op.op) {
    case TfliteOp::kAdd:
      return activation(0);
    case TfliteOp::kConcatenation:
      op.axis = options.scalar<int32_t>(0, 0);
      return activation(1);
    case TfliteOp::kConv2d:
      return window() && activation(3) && dilation(4);
    case TfliteOp::kDepthwiseConv2d:
      op.depth_multiplier = options.scalar<int32_t>(3, 0);
      return window() && activation(4) && dilation(5) && is_step(op.depth_multiplier);
    case TfliteOp::kMaxPool2d:
      op.filter_x = options.scalar<int32_t>(3, 0);
      op.filter_y = options.scalar<int32_t>(4, 0);
      return window() && activation(5) && is_step(op.filter_x) && is_step(op.filter_y);
    case TfliteOp::kDepthToSpace:
      op.block_size = options.scalar<int32_t>(0, 0);
      return is_step(op.block_size);
    case TfliteOp::kResizeBilinear:
      op.align_corners = options.scalar<uint8_t>(2, 0) != 0;
      op.half_pixel_centres = options.scalar<uint8_t>(3, 0) != 0;
      return true;
    default:
      return true;
  }
}

bool is_known(int code) {
  static constexpr int kKnown[] = {0, 2, 3, 4, 5, 6, 14, 17, 22, 23, 34, 124};
  return std::ranges::find(kKnown, code) != std::end(kKnown);
}

Result<TfliteFile> read_graph(const Node& model) {
  std::vector<int> codes;
  for (const Node& code : model.children(1)) {  // early files keep the code in a byte
    codes.push_back(std::max<int>(code.scalar<int8_t>(0, 0), code.scalar<int32_t>(3, 0)));
  }
  const std::vector<Node> graphs = model.children(2), buffers = model.children(4);
  if (graphs.size() != 1) return error("has {} graphs, one is known", graphs.size());
  TfliteFile file;
  int64_t num_elements = 0;
  for (const Node& node : graphs[0].children(0)) {
    Result<TfliteTensor> tensor = read_tensor(node, buffers);
    if (!tensor) return tensor.failure();
    num_elements += static_cast<int64_t>(tensor->floats.size() + tensor->ints.size());
    if (num_elements > kMaxElements) return error("has more than {} constant values", kMaxElements);
    file.tensors.push_back(std::move(*tensor));
  }
  const auto is_tensor = [&](int i) { return i >= 0 && i < static_cast<int>(file.tensors.size()); };
  for (const Node& node : graphs[0].children(3)) {
    const auto code_idx = node.scalar<uint32_t>(0, 0);
    const int code = code_idx < codes.size() ? codes[code_idx] : -1;
    if (!is_known(code)) return error("has an operator that is not known, number {} of the schema", code);
    TfliteOperator op;
    op.op = static_cast<TfliteOp>(code);
    op.inputs = node.integers<int32_t>(1);
    const std::vector<int> outputs = node.integers<int32_t>(2);
    const bool sound = outputs.size() == 1 && is_tensor(outputs[0]) && !op.inputs.empty() && is_tensor(op.inputs[0]) &&
                       std::ranges::all_of(op.inputs, [&](int i) { return i == -1 || is_tensor(i); });
    const auto options = node.child(4);
    if (!sound || (options && !read_options(*options, op))) {
      return error("operator {} (number {} of the schema) is not as it should be", file.operators.size(), code);
    }
    op.output = outputs[0];
    file.operators.push_back(std::move(op));
  }
  file.inputs = graphs[0].integers<int32_t>(1);
  file.outputs = graphs[0].integers<int32_t>(2);
  if (!std::ranges::all_of(file.inputs, is_tensor) || !std::ranges::all_of(file.outputs, is_tensor)) {
    return error("has inputs or outputs that are no tensors");
  }
  return file;
}

}  // namespace

Result<TfliteFile> read_tflite(const std::filesystem::path& path) {
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  std::ifstream in(path, std::ios::binary);
  if (failed || !in) return error("{}: no such file", path.string());
  if (size > kMaxFileBytes) return error("{}: too large for a network", path.string());
  std::vector<uint8_t> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in) return error("{}: cannot be read", path.string());
  static constexpr std::string_view kIdentifier = "TFL3";
  if (size < 8 || !std::equal(kIdentifier.begin(), kIdentifier.end(), bytes.begin() + 4)) {
    return error("{}: not a TensorFlow Lite file", path.string());
  }
  Node::File file{.verifier = flatbuffers::Verifier(bytes.data(), bytes.size())};
  const size_t root = file.verifier.VerifyOffset(size_t{0});
  std::optional<Node> model;
  if (root != 0) model = Node::at(file, reinterpret_cast<const flatbuffers::Table*>(bytes.data() + root));
  if (!model) return error("{}: damaged or cut short", path.string());
  Result<TfliteFile> graph = read_graph(*model);
  if (file.broken) return error("{}: damaged or cut short", path.string());
  if (!graph) return error("{}: {}", path.string(), graph.error().message);
  return graph;
}

}  // namespace silpose
