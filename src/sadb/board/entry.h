// Entry: a value at an instant, the unit of what a blackboard holds.
// Threads: values.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "silpose/geometry/rigid3.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"

namespace sadb {

// A JSON document, as text; it is not parsed here.
struct Json {
  std::string text;
  bool operator==(const Json&) const = default;
};

// The state of a skeleton: the skeleton's name and a value for each degree of freedom, radians and metres.
struct Pose {
  std::string skeleton;
  std::vector<double> values;
  bool operator==(const Pose&) const = default;
};

using Value = std::variant<double, std::vector<double>, std::string, Json, silpose::Rigid3, Pose, silpose::ByteImage,
                           silpose::Mask>;

// In the order of Value's alternatives.
enum class Type { kScalar, kVector, kText, kJson, kTransform, kPose, kImage, kMask };

[[nodiscard]] inline Type type_of(const Value& value) { return static_cast<Type>(value.index()); }

// "scalar", "vector", "text", "json", "transform", "pose", "image", "mask".
[[nodiscard]] std::string_view type_name(Type type);

struct Entry {
  int64_t time_ns = 0;
  Value value;
};

}  // namespace sadb
