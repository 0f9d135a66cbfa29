// Entry: a value at an instant, the unit of what a blackboard holds.
// A Value is cheap to copy where it is large: images and masks are Shared, so that they are never copied on their way
// from a writer through a store to its readers.
// Threads: values. A Shared payload is immutable and may be read by any number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "silpose/geometry/rigid3.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"

namespace sadb {

// A T that nobody can change and that all copies share.
template <class T>
class Shared {
 public:
  Shared() : Shared(T()) {}
  Shared(T value) : value_(std::make_shared<const T>(std::move(value))) {}  // NOLINT: implicit, as Value is

  const T& operator*() const { return *value_; }
  const T* operator->() const { return value_.get(); }

  friend bool operator==(const Shared& a, const Shared& b) { return a.value_ == b.value_ || *a == *b; }

 private:
  std::shared_ptr<const T> value_;
};

// A JSON document, as text; it is not parsed here.
struct Json {
  std::string text;
  bool operator==(const Json&) const = default;
};

// The state of a skeleton: the skeleton's name and a value for each degree of freedom. What the values are is in the
// path's schema (schema.h).
struct Pose {
  std::string skeleton;
  std::vector<double> values;
  bool operator==(const Pose&) const = default;
};

using Value = std::variant<double, std::vector<double>, std::string, Json, silpose::Rigid3, Pose,
                           Shared<silpose::ByteImage>, Shared<silpose::Mask>>;

// In the order of Value's alternatives.
enum class Type { kScalar, kVector, kText, kJson, kTransform, kPose, kImage, kMask };

[[nodiscard]] inline Type type_of(const Value& value) { return static_cast<Type>(value.index()); }

// "scalar", "vector", "text", "json", "transform", "pose", "image", "mask".
[[nodiscard]] std::string_view type_name(Type type);

struct Entry {
  int64_t time_ns = 0;
  Value value;
};

// An entry and where it belongs.
struct PathEntry {
  std::string path;
  int64_t time_ns = 0;
  Value value;
};

}  // namespace sadb
