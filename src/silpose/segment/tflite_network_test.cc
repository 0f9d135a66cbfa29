#include "silpose/segment/tflite_network.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "silpose/base/folder_for_test.h"
#include "silpose/base/rng.h"
#include "silpose/segment/tflite_bytes_for_test.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class TfliteNetworkTest : public FolderTest {
 protected:
  [[nodiscard]] fs::path written(const std::string& bytes) const {
    const fs::path path = folder_ / "net.tflite";
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path;
  }
  // "" where it can be loaded.
  [[nodiscard]] std::string failure(const std::string& bytes) const {
    const auto network = TfliteNetwork::load(written(bytes), {"out"});
    return network ? "" : network.error().message;
  }
};

std::vector<float> random_values(size_t count, uint64_t seed) {
  Rng rng(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(rng.normal());
  return values;
}

// The convolution by its definition, [H, W, C] to [H, W, C]; weights [out, y, x, in], or [1, y, x, C] depthwise.
struct Plain {
  int height, width, channels, filter, stride, num_out;
  bool depthwise = false;
  [[nodiscard]] std::vector<float> same(const std::vector<float>& in, const std::vector<float>& weights,
                                        const std::vector<float>& bias) const {
    const int rows = (height + stride - 1) / stride, columns = (width + stride - 1) / stride;
    const int top = std::max(0, (rows - 1) * stride + filter - height) / 2;
    const int left = std::max(0, (columns - 1) * stride + filter - width) / 2;
    std::vector<float> out;
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        for (int o = 0; o < num_out; ++o) {
          double sum = bias[static_cast<size_t>(o)];
          for (int v = 0; v < filter; ++v) {
            for (int u = 0; u < filter; ++u) {
              const int row = y * stride + v - top, column = x * stride + u - left;
              if (row < 0 || row >= height || column < 0 || column >= width) continue;
              for (int c = 0; c < channels; ++c) {
                if (depthwise && c != o) continue;
                const int w =
                    depthwise ? (v * filter + u) * num_out + o : ((o * filter + v) * filter + u) * channels + c;
                sum += static_cast<double>(in[static_cast<size_t>((row * width + column) * channels + c)]) *
                       weights[static_cast<size_t>(w)];
              }
            }
          }
          out.push_back(static_cast<float>(std::clamp(sum, 0.0, 6.0)));
        }
      }
    }
    return out;
  }
};

void expect_near(const std::vector<float>& chw, const std::vector<float>& hwc, int channels) {
  ASSERT_EQ(chw.size(), hwc.size());
  const size_t plane = hwc.size() / static_cast<size_t>(channels);
  for (size_t i = 0; i < hwc.size(); ++i) {
    const size_t c = i % static_cast<size_t>(channels), at = i / static_cast<size_t>(channels);
    ASSERT_NEAR(chw[c * plane + at], hwc[i], 1e-4) << i;
  }
}

constexpr TfliteBytes::Option kRelu6AtThree{3, 3, true}, kRelu6AtFour{4, 3, true};

// 7x8 by 3x3 at stride 2, 5x5 at 1, and so on: what is added around an even side is more at its end.
TEST_F(TfliteNetworkTest, ConvolutionsPadAsTheFormatSays) {
  for (const auto& [filter, stride] : {std::pair{3, 2}, {3, 1}, {5, 2}, {1, 1}}) {
    const Plain plain{7, 8, 3, filter, stride, 4};
    const std::vector<float> weights = random_values(static_cast<size_t>(4 * filter * filter * 3), 1);
    const std::vector<float> bias = random_values(4, 2), input = random_values(7 * 8 * 3, 3);
    TfliteBytes bytes;
    const int in = bytes.tensor("in", {1, 7, 8, 3}), w = bytes.constant<float>({4, filter, filter, 3}, weights);
    const int b = bytes.constant<float>({4}, bias);
    const int out = bytes.tensor("out", {1, (7 + stride - 1) / stride, (8 + stride - 1) / stride, 4});
    bytes.add(TfliteOp::kConv2d, {in, w, b}, out, {{1, stride}, {2, stride}, kRelu6AtThree});
    auto network = TfliteNetwork::load(written(bytes.finish({in}, {out})), {"out"}).value();
    expect_near(network.run(input)[0], plain.same(input, weights, bias), 4);
  }
}

TEST_F(TfliteNetworkTest, DepthwiseConvolution) {
  const Plain plain{6, 6, 3, 3, 2, 3, true};
  const std::vector<float> weights = random_values(27, 1), bias = random_values(3, 2), input = random_values(108, 3);
  TfliteBytes bytes;
  const int in = bytes.tensor("in", {1, 6, 6, 3}), w = bytes.constant<float>({1, 3, 3, 3}, weights);
  const int b = bytes.constant<float>({3}, bias), out = bytes.tensor("out", {1, 3, 3, 3});
  bytes.add(TfliteOp::kDepthwiseConv2d, {in, w, b}, out, {{1, 2}, {2, 2}, {3, 1}, kRelu6AtFour});
  auto network = TfliteNetwork::load(written(bytes.finish({in}, {out})), {"out"}).value();
  expect_near(network.run(input)[0], plain.same(input, weights, bias), 3);
}

// [[1, 0.5], [0, -2]] as halves, and the same as rows of what is not zero.
TEST_F(TfliteNetworkTest, WeightsMayBeHalvesOrSparse) {
  for (const bool is_sparse : {false, true}) {
    TfliteBytes bytes;
    const int in = bytes.tensor("in", {1, 1, 1, 2}), out = bytes.tensor("out", {1, 1, 1, 2});
    const int w = bytes.tensor("weights", {2, 1, 1, 2}), b = bytes.constant<float>({2}, {0, 10});
    if (is_sparse) {
      bytes.add(TfliteOp::kDensify, {bytes.sparse({2, 1, 1, 2}, {1, 0.5, -2}, {0, 2, 3}, {0, 1, 1})}, w);
    } else {
      bytes.add(TfliteOp::kDequantize, {bytes.constant<uint16_t>({2, 1, 1, 2}, {0x3c00, 0x3800, 0, 0xc000})}, w);
    }
    bytes.add(TfliteOp::kConv2d, {in, w, b}, out, {{1, 1}, {2, 1}});
    auto network = TfliteNetwork::load(written(bytes.finish({in}, {out})), {"out"}).value();
    EXPECT_THAT(network.run(std::vector<float>{3, 4})[0], testing::ElementsAre(5, 2));
  }
}

TEST_F(TfliteNetworkTest, SmallOperators) {
  const auto run = [&](TfliteOp op, const std::vector<int>& from, const std::vector<int>& to,
                       const std::vector<float>& input, const std::vector<TfliteBytes::Option>& options,
                       const std::vector<int32_t>& amounts = {}) {
    TfliteBytes bytes;
    const int in = bytes.tensor("in", from), out = bytes.tensor("out", to);
    std::vector<int> inputs = {in};
    if (!amounts.empty()) inputs.push_back(bytes.constant<int32_t>({static_cast<int>(amounts.size()) / 2, 2}, amounts));
    if (op == TfliteOp::kAdd || op == TfliteOp::kConcatenation) inputs.push_back(in);
    bytes.add(op, inputs, out, options);
    return TfliteNetwork::load(written(bytes.finish({in}, {out})), {"out"}).value().run(input)[0];
  };
  using testing::ElementsAre;
  using testing::FloatNear;
  EXPECT_THAT(run(TfliteOp::kAdd, {1, 1, 2, 1}, {1, 1, 2, 1}, {-1, 4}, {{0, 1, true}}), ElementsAre(0, 8));
  EXPECT_THAT(
      run(TfliteOp::kMaxPool2d, {1, 2, 4, 1}, {1, 1, 2, 1}, {1, 2, 3, 4, 5, 0, 0, 0}, {{1, 2}, {2, 2}, {3, 2}, {4, 2}}),
      ElementsAre(5, 4));
  EXPECT_THAT(run(TfliteOp::kPad, {1, 1, 1, 1}, {1, 2, 2, 1}, {7}, {}, {0, 0, 1, 0, 0, 1, 0, 0}),
              ElementsAre(0, 0, 7, 0));
  EXPECT_THAT(run(TfliteOp::kResizeBilinear, {1, 1, 2, 1}, {1, 1, 4, 1}, {0, 4}, {{3, 1, true}}),
              ElementsAre(0, 1, 3, 4));
  EXPECT_THAT(run(TfliteOp::kLogistic, {1, 1, 1, 1}, {1, 1, 1, 1}, {0}, {}), ElementsAre(0.5));
  EXPECT_THAT(run(TfliteOp::kReshape, {1, 1, 2, 2}, {1, 4}, {1, 2, 3, 4}, {}), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(run(TfliteOp::kConcatenation, {1, 1, 1, 2}, {1, 1, 1, 4}, {1, 2}, {{0, 3}}), ElementsAre(1, 2, 1, 2));
  // Eight channels of one pixel: two of four, row by row; comes out plane by plane.
  EXPECT_THAT(run(TfliteOp::kDepthToSpace, {1, 1, 1, 8}, {1, 2, 2, 2}, {1, 2, 3, 4, 5, 6, 7, 8}, {{0, 2}}),
              ElementsAre(1, 3, 5, 7, 2, 4, 6, 8));
}

std::string small_network(int declared_width = 3) {
  TfliteBytes bytes;
  const int in = bytes.tensor("in", {1, 6, 6, 2}), w = bytes.sparse({1, 1, 1, 2}, {1}, {0, 1}, {1});
  const int dense = bytes.tensor("dense", {1, 1, 1, 2}), b = bytes.constant<uint16_t>({1}, {0x3c00});
  const int wide = bytes.tensor("wide", {1}), out = bytes.tensor("out", {1, 3, declared_width, 1});
  bytes.add(TfliteOp::kDensify, {w}, dense);
  bytes.add(TfliteOp::kDequantize, {b}, wide);
  bytes.add(TfliteOp::kConv2d, {in, dense, wide}, out, {{1, 2}, {2, 2}});
  return bytes.finish({in}, {out});
}

TEST_F(TfliteNetworkTest, WhatDoesNotFitIsNamed) {
  EXPECT_EQ(failure(small_network()), "");
  EXPECT_THAT(failure(small_network(4)), HasSubstr("net.tflite: operator 2 (number 3 of the schema) does not fit"));
  EXPECT_THAT(failure(""), HasSubstr("net.tflite: not a TensorFlow Lite file"));
  EXPECT_THAT(failure("no network at all"), HasSubstr("not a TensorFlow Lite file"));
  EXPECT_THAT(TfliteNetwork::load(written(small_network()), {"mask"}).error().message, HasSubstr("no output 'mask'"));
  EXPECT_THAT(TfliteNetwork::load(folder_ / "absent", {"out"}).error().message, HasSubstr("absent: no such file"));
  TfliteBytes unknown;
  const int in = unknown.tensor("in", {1, 1, 1, 1}), out = unknown.tensor("out", {1, 1, 1, 1});
  unknown.add(static_cast<TfliteOp>(99), {in}, out);
  EXPECT_THAT(failure(unknown.finish({in}, {out})), HasSubstr("operator that is not known, number 99"));
}

// Each of them may be that large, but not all together: sparse constants take few bytes of the file.
TEST_F(TfliteNetworkTest, ConstantsThatWouldFillTheMemoryAreRefused) {
  TfliteBytes bytes;
  std::vector<uint8_t> starts(65, 1);
  starts[0] = 0;
  for (int i = 0; i < 2; ++i) bytes.sparse({64, 1 << 20}, {1}, starts, {0});
  const int in = bytes.tensor("in", {1, 1, 1, 1});
  EXPECT_THAT(failure(bytes.finish({in}, {in})), HasSubstr("has more than 67108864 constant values"));
}

// A file cut anywhere is refused, or at least harmless where only padding is gone.
TEST_F(TfliteNetworkTest, CutFilesAreRefused) {
  const std::string whole = small_network();
  int num_refused = 0, num_cut = 0;
  for (size_t length = 0; length < whole.size(); length += 7, ++num_cut) {
    num_refused += failure(whole.substr(0, length)).empty() ? 0 : 1;
  }
  EXPECT_GE(num_refused, num_cut - 1);
  EXPECT_THAT(failure(whole.substr(0, whole.size() / 2)), HasSubstr("damaged or cut short"));
}

// Must not crash, hang or throw; some changes go unnoticed, most do not.
TEST_F(TfliteNetworkTest, DamagedFilesAreHarmless) {
  const std::string whole = small_network();
  int num_refused = 0;
  for (uint64_t seed = 0; seed < 400; ++seed) {
    Rng rng(seed);
    std::string damaged = whole;
    const int num_changes = 1 + static_cast<int>(seed % 3);
    for (int i = 0; i < num_changes; ++i) {
      damaged[static_cast<size_t>(rng.uniform() * static_cast<double>(whole.size() - 1))] =
          static_cast<char>(static_cast<int>(rng.uniform() * 256));
    }
    num_refused += failure(damaged).empty() ? 0 : 1;
  }
  EXPECT_GT(num_refused, 100);
}

}  // namespace
}  // namespace silpose
