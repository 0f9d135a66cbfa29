#include "silpose/segment/tflite_network.h"

#include <algorithm>
#include <opencv2/dnn.hpp>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/segment/tflite_layers.h"

namespace silpose {
namespace {

// Which operators the outputs depend on.
std::vector<bool> needed(const TfliteFile& file, const std::vector<int>& outputs) {
  std::vector<bool> is_wanted(file.tensors.size(), false), is_needed(file.operators.size(), false);
  for (const int output : outputs) is_wanted[static_cast<size_t>(output)] = true;
  for (size_t i = file.operators.size(); i-- > 0;) {
    const TfliteOperator& op = file.operators[i];
    is_needed[i] = is_wanted[static_cast<size_t>(op.output)];
    if (!is_needed[i]) continue;
    for (const int input : op.inputs) {
      if (input >= 0) is_wanted[static_cast<size_t>(input)] = true;
    }
  }
  return is_needed;
}

}  // namespace

struct TfliteNetwork::Impl {
  cv::dnn::Net net;
  std::vector<int> input_shape;
  std::vector<std::vector<int>> output_shapes;
  std::vector<cv::String> output_names;
};

TfliteNetwork::TfliteNetwork(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TfliteNetwork::TfliteNetwork(TfliteNetwork&&) noexcept = default;
TfliteNetwork& TfliteNetwork::operator=(TfliteNetwork&&) noexcept = default;
TfliteNetwork::~TfliteNetwork() = default;

Result<TfliteNetwork> TfliteNetwork::load(const std::filesystem::path& path, const std::vector<std::string>& outputs) {
  const Result<TfliteFile> file = read_tflite(path);
  if (!file) return file.failure();
  Result<TfliteNetwork> network = build(*file, outputs);
  if (!network) return silpose::error("{}: {}", path.string(), network.error().message);
  return network;
}

Result<TfliteNetwork> TfliteNetwork::build(const TfliteFile& file, const std::vector<std::string>& outputs) {
  if (file.inputs.size() != 1) return error("has {} inputs, one is known", file.inputs.size());
  const std::vector<int>& input = file.tensors[static_cast<size_t>(file.inputs[0])].shape;
  if (input.size() != 4 || input[0] != 1) return error("its input is not one image");
  std::vector<int> wanted;
  for (const std::string& name : outputs) {
    const auto found = std::ranges::find_if(
        file.outputs, [&](int output) { return file.tensors[static_cast<size_t>(output)].name == name; });
    if (found == file.outputs.end()) return error("has no output '{}'", name);
    wanted.push_back(*found);
  }
  auto impl = std::make_unique<Impl>();
  try {
    TfliteLayers layers(file, impl->net);
    const std::vector<bool> is_needed = needed(file, wanted);
    for (size_t i = 0; i < file.operators.size(); ++i) {
      if (is_needed[i] && !layers.add(file.operators[i])) {
        return error("operator {} (number {} of the schema) does not fit or is used in a way that is not built", i,
                     static_cast<int>(file.operators[i].op));
      }
    }
    for (const int output : wanted) {
      if (layers.layer(output) <= 0) return error("its output comes from nowhere");
      impl->output_names.push_back(layers.name_of(output));
      impl->output_shapes.push_back(file.tensors[static_cast<size_t>(output)].shape);
    }
    impl->input_shape = {input[1], input[2], input[3]};
    impl->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    impl->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    TfliteNetwork network(std::move(impl));
    // Once through: memory is taken now, and what OpenCV refuses is an error of the file.
    const std::vector<float> nothing(static_cast<size_t>(tflite_volume(network.impl_->input_shape)), 0.0f);
    const std::vector<std::vector<float>> found = network.run(nothing);
    for (size_t i = 0; i < found.size(); ++i) {
      if (static_cast<int64_t>(found[i].size()) != tflite_volume(network.output_shapes()[i])) {
        return error("output '{}' has another size than the file says", outputs[i]);
      }
    }
    return network;
  } catch (const cv::Exception& exception) {
    return error("cannot be computed: {}", exception.err);
  }
}

const std::vector<int>& TfliteNetwork::input_shape() const { return impl_->input_shape; }
const std::vector<std::vector<int>>& TfliteNetwork::output_shapes() const { return impl_->output_shapes; }

std::vector<std::vector<float>> TfliteNetwork::run(std::span<const float> input) {
  const std::vector<int>& shape = impl_->input_shape;
  check(input.size() == static_cast<size_t>(tflite_volume(shape)), "TfliteNetwork: {} numbers for an input {}x{}x{}",
        input.size(), shape[0], shape[1], shape[2]);
  const int sizes[4] = {1, shape[2], shape[0], shape[1]};
  cv::Mat blob(4, sizes, CV_32F);
  const size_t channels = static_cast<size_t>(shape[2]), plane = input.size() / channels;
  for (size_t i = 0; i < plane; ++i) {
    for (size_t c = 0; c < channels; ++c) blob.ptr<float>()[c * plane + i] = input[i * channels + c];
  }
  impl_->net.setInput(blob);
  std::vector<cv::Mat> blobs;
  impl_->net.forward(blobs, impl_->output_names);
  std::vector<std::vector<float>> outputs;
  for (const cv::Mat& output : blobs) {
    const float* begin = output.ptr<float>();
    outputs.emplace_back(begin, begin + output.total());
  }
  return outputs;
}

}  // namespace silpose
