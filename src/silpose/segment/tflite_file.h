// read_tflite(): a network's description in a TensorFlow Lite file, as plain values.
// Based on: the public TFLite schema, whose fields are read by number through FlatBuffers; every offset and size is
// checked first, so that a damaged file is only an error. Constants come out as 32-bit numbers, whether the file holds
// them as halves or sparse. Threads: a function without state.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "silpose/base/result.h"

namespace silpose {

struct TfliteTensor {
  std::string name;
  std::vector<int> shape;     // in TensorFlow's order: [1, H, W, C]
  std::vector<float> floats;  // of a constant, as many as the shape says; else empty
  std::vector<int32_t> ints;
};

// The numbers are the schema's.
enum class TfliteOp {
  kAdd = 0,
  kConcatenation = 2,
  kConv2d = 3,
  kDepthwiseConv2d = 4,
  kDepthToSpace = 5,
  kDequantize = 6,
  kLogistic = 14,
  kMaxPool2d = 17,
  kReshape = 22,
  kResizeBilinear = 23,
  kPad = 34,
  kDensify = 124,
};

enum class TfliteActivation { kNone = 0, kRelu = 1, kRelu6 = 3 };

// Fields that an operator does not have keep these defaults.
struct TfliteOperator {
  TfliteOp op = TfliteOp::kAdd;
  std::vector<int> inputs;  // tensors; -1: an optional one that is absent
  int output = 0;           // tensor
  TfliteActivation activation = TfliteActivation::kNone;
  bool same_padding = true;  // else none ("valid")
  int stride_x = 1, stride_y = 1, dilation_x = 1, dilation_y = 1, filter_x = 1, filter_y = 1;
  int depth_multiplier = 1;
  int axis = 0, block_size = 1;
  bool align_corners = false, half_pixel_centres = false;
};

struct TfliteFile {
  std::vector<TfliteTensor> tensors;
  std::vector<TfliteOperator> operators;  // each after those whose outputs it takes
  std::vector<int> inputs, outputs;       // tensors
};

// Errors: the file cannot be read, is damaged, or holds what this reader does not know.
Result<TfliteFile> read_tflite(const std::filesystem::path& path);

}  // namespace silpose
