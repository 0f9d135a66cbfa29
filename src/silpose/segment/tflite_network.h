// TfliteNetwork: runs a network from a TensorFlow Lite file on OpenCV's dnn layers.
// Based on: tflite_file.h. Layers are built one by one; images inside are [C, H, W] where the file has [H, W, C].
// Threads: one thread per network (it keeps its buffers); works on all cores itself.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "silpose/base/result.h"

namespace silpose {

struct TfliteFile;

class TfliteNetwork {
 public:
  // Only what the named outputs need is built. Errors: those of read_tflite(); no such output; not exactly one input
  // [1, H, W, C]; an operator whose sizes do not fit together or that this class does not build.
  static Result<TfliteNetwork> load(const std::filesystem::path& path, const std::vector<std::string>& outputs);
  static Result<TfliteNetwork> build(const TfliteFile& file, const std::vector<std::string>& outputs);

  TfliteNetwork(TfliteNetwork&&) noexcept;
  TfliteNetwork& operator=(TfliteNetwork&&) noexcept;
  ~TfliteNetwork();

  // Of the input: H, W, C. Of the outputs: as the file has them.
  [[nodiscard]] const std::vector<int>& input_shape() const;
  [[nodiscard]] const std::vector<std::vector<int>>& output_shapes() const;

  // `input` [H, W, C] to every named output in their order; those of four axes come as [C, H, W].
  [[nodiscard]] std::vector<std::vector<float>> run(std::span<const float> input);

 private:
  struct Impl;
  explicit TfliteNetwork(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace silpose
