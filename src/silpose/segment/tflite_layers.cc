#include "silpose/segment/tflite_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace silpose {
namespace {

using cv::dnn::DictValue;
using cv::dnn::LayerParams;

DictValue integers(const std::vector<int>& values) {
  return DictValue::arrayInt(values.data(), static_cast<int>(values.size()));
}

constexpr int kMaxFilter = 1024;  // [guess] along one axis

// Windows of a convolution along one axis: how many, and what has to be added before and after the image.
struct Windows {
  int count = 0, before = 0, after = 0;
};

Windows windows(int size, int filter, int stride, int dilation, bool same_padding) {
  if (filter > kMaxFilter) return {};
  const int reach = (filter - 1) * dilation + 1;
  if (!same_padding) return {size < reach ? 0 : (size - reach) / stride + 1, 0, 0};
  const int count = (size + stride - 1) / stride;
  const int missing = std::max(0, (count - 1) * stride + reach - size);
  return {count, missing / 2, missing - missing / 2};  // what is odd comes last
}

bool takes_only_layers(const TfliteOperator& op) {
  return op.op == TfliteOp::kAdd || op.op == TfliteOp::kConcatenation;
}

}  // namespace

int64_t tflite_volume(const std::vector<int>& shape) {
  return std::accumulate(shape.begin(), shape.end(), int64_t{1}, std::multiplies<>());
}

TfliteLayers::TfliteLayers(const TfliteFile& file, cv::dnn::Net& net)
    : file_(file), net_(net), layer_of_(file.tensors.size(), -1), constant_of_(file.tensors.size(), -1) {
  for (size_t i = 0; i < file.tensors.size(); ++i) {
    const TfliteTensor& tensor = file.tensors[i];
    if (!tensor.floats.empty() || !tensor.ints.empty()) constant_of_[i] = static_cast<int>(i);
  }
  layer_of_[static_cast<size_t>(file.inputs[0])] = 0;
}

bool TfliteLayers::add(const TfliteOperator& op) {
  const auto output = static_cast<size_t>(op.output);
  if (op.op == TfliteOp::kDequantize || op.op == TfliteOp::kDensify) {  // done by the reader
    constant_of_[output] = constant_of_[static_cast<size_t>(op.inputs[0])];
    return constant_of_[output] >= 0 && shape(op.output) == shape(op.inputs[0]);
  }
  for (size_t i = 0; i < op.inputs.size() && (i == 0 || takes_only_layers(op)); ++i) {
    if (op.inputs[i] < 0 || layer(op.inputs[i]) < 0) return false;
  }
  const std::vector<int>&in = shape(op.inputs[0]), &out = shape(op.output);
  switch (op.op) {
    case TfliteOp::kConv2d:
    case TfliteOp::kDepthwiseConv2d:
      return add_convolution(op, in, out);
    case TfliteOp::kMaxPool2d:
      return add_max_pool(op, in, out);
    case TfliteOp::kAdd: {
      if (op.inputs.size() != 2 || in != out || shape(op.inputs[1]) != out) return false;
      LayerParams params;
      params.set("operation", "sum");
      return finish(op, insert("Eltwise", params, {layer(op.inputs[0]), layer(op.inputs[1])}));
    }
    case TfliteOp::kPad:
      return add_pad(op, in, out);
    case TfliteOp::kResizeBilinear: {
      if (in.size() != 4 || out.size() != 4 || out[3] != in[3] || !op.half_pixel_centres || op.align_corners) {
        return false;
      }
      LayerParams params;
      params.set("height", out[1]);
      params.set("width", out[2]);
      params.set("interpolation", "bilinear");
      params.set("half_pixel_centers", true);
      return finish(op, insert("Resize", params, {layer(op.inputs[0])}));
    }
    case TfliteOp::kReshape: {
      if (tflite_volume(in) != tflite_volume(out) || out.size() == 4) return false;
      int from = layer(op.inputs[0]);
      if (in.size() == 4) from = permuted(from, {0, 2, 3, 1});
      return finish(op, reshaped(from, out));
    }
    case TfliteOp::kLogistic:
      return in == out && finish(op, insert("Sigmoid", {}, {layer(op.inputs[0])}));
    case TfliteOp::kConcatenation:
      return add_concatenation(op, out);
    case TfliteOp::kDepthToSpace: {
      const int b = op.block_size;
      if (in.size() != 4 || b > in[3] || out != std::vector<int>{1, in[1] * b, in[2] * b, in[3] / (b * b)} ||
          in[3] % (b * b) != 0) {
        return false;
      }
      const int parts = reshaped(layer(op.inputs[0]), {1, b, b, out[3], in[1], in[2]});
      return finish(op, reshaped(permuted(parts, {0, 3, 4, 1, 5, 2}), {1, out[3], out[1], out[2]}));
    }
    default:
      return false;
  }
}

const TfliteTensor* TfliteLayers::constant(const TfliteOperator& op, size_t input) const {
  if (input >= op.inputs.size() || op.inputs[input] < 0) return nullptr;
  const int source = constant_of_[static_cast<size_t>(op.inputs[input])];
  return source < 0 ? nullptr : &file_.tensors[static_cast<size_t>(source)];
}
int TfliteLayers::insert(const std::string& type, LayerParams params, const std::vector<int>& from) {
  const int id = net_.addLayer(fmt::format("{}_{}", type, num_layers_++), type, params);
  for (size_t i = 0; i < from.size(); ++i) net_.connect(from[i], 0, id, static_cast<int>(i));
  return id;
}
int TfliteLayers::permuted(int from, const std::vector<int>& order) {
  LayerParams params;
  params.set("order", integers(order));
  return insert("Permute", params, {from});
}
int TfliteLayers::reshaped(int from, const std::vector<int>& to) {
  LayerParams params;
  params.set("dim", integers(to));
  return insert("Reshape", params, {from});
}
int TfliteLayers::padded(int from, int top, int bottom, int left, int right) {
  LayerParams params;
  params.set("paddings", integers({0, 0, 0, 0, top, bottom, left, right}));
  return insert("Padding", params, {from});
}

bool TfliteLayers::finish(const TfliteOperator& op, int id) {
  if (op.activation == TfliteActivation::kRelu) id = insert("ReLU", {}, {id});
  if (op.activation == TfliteActivation::kRelu6) {
    LayerParams params;
    params.set("min_value", 0.0f);
    params.set("max_value", 6.0f);
    id = insert("ReLU6", params, {id});
  }
  layer_of_[static_cast<size_t>(op.output)] = id;
  return true;
}

bool TfliteLayers::add_convolution(const TfliteOperator& op, const std::vector<int>& in, const std::vector<int>& out) {
  const TfliteTensor *weights = constant(op, 1), *bias = constant(op, 2);
  if (in.size() != 4 || weights == nullptr || weights->shape.size() != 4 || weights->floats.empty()) return false;
  const bool is_depthwise = op.op == TfliteOp::kDepthwiseConv2d;
  const std::vector<int>& filter = weights->shape;  // [out, y, x, in], depthwise [1, y, x, out]
  const int num_out = is_depthwise ? filter[3] : filter[0], num_in = is_depthwise ? 1 : filter[3];
  const bool fits = is_depthwise ? filter[0] == 1 && int64_t{in[3]} * op.depth_multiplier == num_out : num_in == in[3];
  const Windows y = windows(in[1], filter[1], op.stride_y, op.dilation_y, op.same_padding);
  const Windows x = windows(in[2], filter[2], op.stride_x, op.dilation_x, op.same_padding);
  if (!fits || out != std::vector<int>{1, y.count, x.count, num_out}) return false;
  if (bias != nullptr && bias->floats.size() != static_cast<size_t>(num_out)) return false;

  LayerParams params;
  params.set("num_output", num_out);
  params.set("kernel_h", filter[1]);
  params.set("kernel_w", filter[2]);
  params.set("stride_h", op.stride_y);
  params.set("stride_w", op.stride_x);
  params.set("dilation_h", op.dilation_y);
  params.set("dilation_w", op.dilation_x);
  params.set("group", is_depthwise ? in[3] : 1);
  params.set("bias_term", bias != nullptr);
  // To [out, in, y, x].
  const int sizes[4] = {num_out, num_in, filter[1], filter[2]};
  cv::Mat kernel(4, sizes, CV_32F);
  const int plane = filter[1] * filter[2];
  for (int o = 0; o < num_out; ++o) {
    for (int i = 0; i < num_in; ++i) {
      for (int p = 0; p < plane; ++p) {
        const int from = is_depthwise ? p * num_out + o : (o * plane + p) * num_in + i;
        kernel.ptr<float>()[(o * num_in + i) * plane + p] = weights->floats[static_cast<size_t>(from)];
      }
    }
  }
  params.blobs.push_back(kernel);
  if (bias != nullptr) params.blobs.push_back(cv::Mat(bias->floats, true).reshape(1, 1));

  // The layer itself pads alike on both sides only.
  const bool is_even = y.before == y.after && x.before == x.after;
  params.set("pad_h", is_even ? y.before : 0);
  params.set("pad_w", is_even ? x.before : 0);
  const int from = is_even ? layer(op.inputs[0]) : padded(layer(op.inputs[0]), y.before, y.after, x.before, x.after);
  return finish(op, insert("Convolution", params, {from}));
}

bool TfliteLayers::add_max_pool(const TfliteOperator& op, const std::vector<int>& in, const std::vector<int>& out) {
  if (in.size() != 4) return false;
  const Windows y = windows(in[1], op.filter_y, op.stride_y, 1, op.same_padding);
  const Windows x = windows(in[2], op.filter_x, op.stride_x, 1, op.same_padding);
  if (y.after != 0 || x.after != 0 || out != std::vector<int>{1, y.count, x.count, in[3]}) return false;
  LayerParams params;
  params.set("pool", "max");
  params.set("kernel_h", op.filter_y);
  params.set("kernel_w", op.filter_x);
  params.set("stride_h", op.stride_y);
  params.set("stride_w", op.stride_x);
  params.set("ceil_mode", false);
  return finish(op, insert("Pooling", params, {layer(op.inputs[0])}));
}

bool TfliteLayers::add_pad(const TfliteOperator& op, const std::vector<int>& in, const std::vector<int>& out) {
  const TfliteTensor* amounts = constant(op, 1);
  if (amounts == nullptr || amounts->ints.size() != 8 || in.size() != 4 || out.size() != 4) return false;
  const std::vector<int32_t>& by = amounts->ints;  // [axis][before, after]
  for (size_t axis = 0; axis < 4; ++axis) {
    const int32_t before = by[2 * axis], after = by[2 * axis + 1];
    const bool may_grow = axis == 1 || axis == 2;
    if (before < 0 || after < 0 || (!may_grow && before + after != 0)) return false;
    if (int64_t{in[axis]} + before + after != out[axis]) return false;
  }
  return finish(op, padded(layer(op.inputs[0]), by[2], by[3], by[4], by[5]));
}

bool TfliteLayers::add_concatenation(const TfliteOperator& op, const std::vector<int>& out) {
  const auto rank = static_cast<int>(out.size());
  const int axis = op.axis < 0 ? op.axis + rank : op.axis;
  if (axis < 0 || axis >= rank) return false;
  int64_t length = 0;
  std::vector<int> layers;
  for (const int input : op.inputs) {
    std::vector<int> of_input = shape(input);
    if (static_cast<int>(of_input.size()) != rank) return false;
    length += of_input[static_cast<size_t>(axis)];
    of_input[static_cast<size_t>(axis)] = out[static_cast<size_t>(axis)];
    if (of_input != out) return false;
    layers.push_back(layer(input));
  }
  static constexpr int kAxisInside[4] = {0, 2, 3, 1};
  LayerParams params;
  params.set("axis", rank == 4 ? kAxisInside[axis] : axis);
  return length == out[static_cast<size_t>(axis)] && finish(op, insert("Concat", params, layers));
}

}  // namespace silpose
