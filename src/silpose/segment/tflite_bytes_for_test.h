// A TensorFlow Lite file put together by hand, for tests.
#pragma once

#include <flatbuffers/flatbuffers.h>

#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "silpose/segment/tflite_file.h"

namespace silpose {

class TfliteBytes {
 public:
  struct Option {
    int slot;
    int value;
    bool is_byte = false;
  };
  enum Type { kFloat32 = 0, kFloat16 = 1, kInt32 = 2 };

  // Both give the tensor's number. Halves are given as their bits.
  int tensor(const std::string& name, const std::vector<int>& shape) { return add(name, shape, kFloat32, {}, {}); }
  template <class T>
  int constant(const std::vector<int>& shape, const std::vector<T>& values) {
    std::vector<uint8_t> bytes(values.size() * sizeof(T));
    std::memcpy(bytes.data(), values.data(), bytes.size());
    const Type type = sizeof(T) == 2 ? kFloat16 : std::is_same_v<T, int32_t> ? kInt32 : kFloat32;
    return add("constant", shape, type, bytes, {});
  }
  // Rows hold only what is not zero: where each row starts, and the columns.
  int sparse(const std::vector<int>& shape, const std::vector<float>& values, const std::vector<uint8_t>& starts,
             const std::vector<uint8_t>& columns) {
    std::vector<int> order;
    std::vector<flatbuffers::Offset<void>> dimensions;
    for (size_t i = 0; i < shape.size(); ++i) {
      order.push_back(static_cast<int>(i));
      if (i + 1 < shape.size()) {
        dimensions.push_back(table({{1, shape[i]}}, {}));
      } else {
        const auto of_starts = table({}, {{0, builder_.CreateVector(starts).Union()}});
        const auto of_columns = table({}, {{0, builder_.CreateVector(columns).Union()}});
        dimensions.push_back(table({{0, 1, true}, {2, 3, true}, {4, 3, true}}, {{3, of_starts}, {5, of_columns}}));
      }
    }
    const auto of_order = builder_.CreateVector(order).Union();
    const auto of_dimensions = builder_.CreateVector(dimensions).Union();
    std::vector<uint8_t> bytes(values.size() * sizeof(float));
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return add("sparse", shape, kFloat32, bytes, table({}, {{0, of_order}, {2, of_dimensions}}));
  }

  void add(TfliteOp op, const std::vector<int>& inputs, int output, const std::vector<Option>& options = {}) {
    const auto code = table({{0, std::min(static_cast<int>(op), 127), true}, {3, static_cast<int>(op)}}, {});
    const auto of_inputs = builder_.CreateVector(inputs).Union();
    const auto of_outputs = builder_.CreateVector(std::vector<int>{output}).Union();
    const auto of_options = table(options, {});
    operators_.push_back(table({{0, static_cast<int>(codes_.size())}, {3, 1, true}},
                               {{1, of_inputs}, {2, of_outputs}, {4, of_options}}));
    codes_.push_back(code);
  }

  std::string finish(const std::vector<int>& inputs, const std::vector<int>& outputs) {
    const auto tensors = builder_.CreateVector(tensors_).Union(), operators = builder_.CreateVector(operators_).Union();
    const auto of_inputs = builder_.CreateVector(inputs).Union(), of_outputs = builder_.CreateVector(outputs).Union();
    const auto graph = table({}, {{0, tensors}, {1, of_inputs}, {2, of_outputs}, {3, operators}});
    const auto graphs = builder_.CreateVector(std::vector{graph}).Union();
    const auto codes = builder_.CreateVector(codes_).Union(), buffers = builder_.CreateVector(buffers_).Union();
    builder_.Finish(table({{0, 3}}, {{1, codes}, {2, graphs}, {4, buffers}}), "TFL3");
    return {reinterpret_cast<const char*>(builder_.GetBufferPointer()), builder_.GetSize()};
  }

 private:
  using Offset = flatbuffers::Offset<void>;
  static flatbuffers::voffset_t field(int slot) { return static_cast<flatbuffers::voffset_t>(4 + 2 * slot); }

  Offset table(const std::vector<Option>& scalars, const std::vector<std::pair<int, Offset>>& children) {
    const auto start = builder_.StartTable();
    builder_.ForceDefaults(true);
    for (const Option& scalar : scalars) {
      if (scalar.is_byte) {
        builder_.AddElement<int8_t>(field(scalar.slot), static_cast<int8_t>(scalar.value), 0);
      } else {
        builder_.AddElement<int32_t>(field(scalar.slot), scalar.value, 0);
      }
    }
    for (const auto& [slot, child] : children) builder_.AddOffset(field(slot), child);
    return {builder_.EndTable(start)};
  }

  int add(const std::string& name, const std::vector<int>& shape, Type type, const std::vector<uint8_t>& bytes,
          Offset sparsity) {
    const auto of_bytes = builder_.CreateVector(bytes).Union();
    buffers_.push_back(table({}, {{0, of_bytes}}));
    std::vector<std::pair<int, Offset>> children = {{0, builder_.CreateVector(shape).Union()},
                                                    {3, builder_.CreateString(name).Union()}};
    if (!sparsity.IsNull()) children.emplace_back(6, sparsity);
    tensors_.push_back(table({{1, type, true}, {2, static_cast<int>(buffers_.size()) - 1}}, children));
    return static_cast<int>(tensors_.size()) - 1;
  }

  flatbuffers::FlatBufferBuilder builder_;
  std::vector<Offset> tensors_, buffers_, operators_, codes_;
};

}  // namespace silpose
