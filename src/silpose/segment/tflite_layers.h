// TfliteLayers: the operators of a TensorFlow Lite file as layers of OpenCV's dnn module, one operator at a time.
// Images inside are [1, C, H, W] where the file has [1, H, W, C].
// Threads: one thread per object.
#pragma once

#include <opencv2/dnn.hpp>
#include <string>
#include <vector>

#include "silpose/segment/tflite_file.h"

namespace silpose {

int64_t tflite_volume(const std::vector<int>& shape);

// A tensor is known by the layer that makes it.
class TfliteLayers {
 public:
  // Both must outlive the object. REQUIRES: one input.
  TfliteLayers(const TfliteFile& file, cv::dnn::Net& net);

  // False where the operator's sizes do not fit together, or it is used in a way that is not built. Errors: throws
  // cv::Exception where OpenCV refuses.
  bool add(const TfliteOperator& op);

  // -1 where nothing makes the tensor.
  [[nodiscard]] int layer(int tensor) const { return layer_of_[static_cast<size_t>(tensor)]; }
  [[nodiscard]] std::string name_of(int tensor) const { return net_.getLayer(layer(tensor))->name; }

 private:
  [[nodiscard]] const std::vector<int>& shape(int tensor) const {
    return file_.tensors[static_cast<size_t>(tensor)].shape;
  }
  // Null where the tensor is none.
  [[nodiscard]] const TfliteTensor* constant(const TfliteOperator& op, size_t input) const;
  int insert(const std::string& type, cv::dnn::LayerParams params, const std::vector<int>& from);
  int permuted(int from, const std::vector<int>& order);
  int reshaped(int from, const std::vector<int>& to);
  int padded(int from, int top, int bottom, int left, int right);
  bool finish(const TfliteOperator& op, int id);
  bool add_convolution(const TfliteOperator& op, const std::vector<int>& in, const std::vector<int>& out);
  bool add_max_pool(const TfliteOperator& op, const std::vector<int>& in, const std::vector<int>& out);
  bool add_pad(const TfliteOperator& op, const std::vector<int>& in, const std::vector<int>& out);
  bool add_concatenation(const TfliteOperator& op, const std::vector<int>& out);

  const TfliteFile& file_;
  cv::dnn::Net& net_;
  std::vector<int> layer_of_, constant_of_;  // [tensors] -1: none
  int num_layers_ = 0;
};

}  // namespace silpose
