// AlignedFloats: an array of numbers, aligned for vector registers, as is every row of kLanes numbers.
// Threads: a value.
#pragma once

#include <cstddef>
#include <vector>

namespace silpose {

class AlignedFloats {
 public:
  static constexpr size_t kLanes = 16;  // the widest registers

  // `count` rounded up to whole registers.
  [[nodiscard]] static constexpr size_t padded(size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

  // New numbers are zero, old ones stay.
  void resize(size_t count) { chunks_.resize(padded(count) / kLanes); }

  [[nodiscard]] size_t size() const { return chunks_.size() * kLanes; }
  [[nodiscard]] float* data() { return reinterpret_cast<float*>(chunks_.data()); }
  [[nodiscard]] const float* data() const { return reinterpret_cast<const float*>(chunks_.data()); }

 private:
  struct alignas(kLanes * sizeof(float)) Chunk {
    float values[kLanes] = {};
  };
  std::vector<Chunk> chunks_;
};

}  // namespace silpose
