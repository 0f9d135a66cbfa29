#include "sadb/board/time_access.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "silpose/base/check.h"

namespace sadb {
namespace {

using silpose::error;
using silpose::Result;
using silpose::Rigid3;

constexpr std::array<std::string_view, 6> kMethodNames = {"latest", "nearest", "before", "after", "hold", "linear"};

// Of later and earlier times: any two int64 differ by less than 2^64.
uint64_t nanoseconds_between(int64_t earlier, int64_t later) {
  return static_cast<uint64_t>(later) - static_cast<uint64_t>(earlier);
}

Reading recorded(const Entry& entry) {
  return {entry.value, entry.time_ns, How::kRecorded, entry.time_ns, entry.time_ns};
}

double mix(double a, double b, double share) { return a + share * (b - a); }

std::vector<double> mix(const std::vector<double>& a, const std::vector<double>& b, double share) {
  std::vector<double> result(a.size());
  for (size_t i = 0; i < a.size(); ++i) result[i] = mix(a[i], b[i], share);
  return result;
}

Rigid3 mix(const Rigid3& a, const Rigid3& b, double share) {
  const Eigen::Quaterniond from(a.rotation), to(b.rotation);
  return {from.slerp(share, to).toRotationMatrix(), a.translation + share * (b.translation - a.translation)};
}

Result<Value> mix(const Pose& a, const Pose& b, double share, const std::optional<PoseSchema>& schema) {
  if (a.skeleton != b.skeleton || a.values.size() != b.values.size()) {
    return error("poses of skeletons '{}' ({} values) and '{}' ({} values) cannot be interpolated", a.skeleton,
                 a.values.size(), b.skeleton, b.values.size());
  }
  Pose result{a.skeleton, mix(a.values, b.values, share)};
  if (!schema) return Value(std::move(result));
  silpose::check(schema->dofs.size() == a.values.size(), "read_at: {} values by a schema of {}", a.values.size(),
                 schema->dofs.size());
  for (size_t d = 0; d < result.values.size(); ++d) {
    const double period = schema->dofs[d].period;
    const double change = b.values[d] - a.values[d];
    if (period > 0 && std::abs(change) > period / 2) {
      result.values[d] = a.values[d] + share * std::remainder(change, period);
    }
  }
  return Value(std::move(result));
}

Result<Value> mix(const Value& a, const Value& b, double share, const Schema& schema) {
  switch (type_of(a)) {
    case Type::kScalar:
      return Value(mix(std::get<double>(a), std::get<double>(b), share));
    case Type::kVector: {
      const auto& from = std::get<std::vector<double>>(a);
      const auto& to = std::get<std::vector<double>>(b);
      if (from.size() != to.size()) {
        return error("vectors of {} and {} numbers cannot be interpolated", from.size(), to.size());
      }
      return Value(mix(from, to, share));
    }
    case Type::kTransform:
      return Value(mix(std::get<Rigid3>(a), std::get<Rigid3>(b), share));
    case Type::kPose:
      return mix(std::get<Pose>(a), std::get<Pose>(b), share, schema.pose);
    case Type::kText:
    case Type::kJson:
    case Type::kImage:
    case Type::kMask:
      break;
  }
  return error("type {} cannot be interpolated", type_name(type_of(a)));
}

Result<Reading> read_linear(const Entry& before, const Entry& after, int64_t time_ns, const Schema& schema) {
  if (before.time_ns == time_ns) return recorded(before);
  if (type_of(before.value) != type_of(after.value)) {
    return error("{} and {} cannot be interpolated", type_name(type_of(before.value)), type_name(type_of(after.value)));
  }
  const double share = static_cast<double>(nanoseconds_between(before.time_ns, time_ns)) /
                       static_cast<double>(nanoseconds_between(before.time_ns, after.time_ns));
  Result<Value> value = mix(before.value, after.value, share, schema);
  if (!value) return value.failure();
  return Reading{*std::move(value), time_ns, How::kInterpolated, before.time_ns, after.time_ns};
}

}  // namespace

Result<Reading> read_at(const Neighbours& neighbours, int64_t time_ns, TimeAccess access, const Schema& schema) {
  const Method method = access.method;
  const Entry* const before = neighbours.at_or_before;
  const Entry* const after = neighbours.at_or_after;
  if (method == Method::kLatest) {
    if (!neighbours.latest) return error("no entries");
    return recorded(*neighbours.latest);
  }
  if (method == Method::kNearest) {
    if (!before && !after) return error("no entries");
    if (!before || !after) return recorded(before ? *before : *after);
    const bool earlier_is_nearer =
        nanoseconds_between(before->time_ns, time_ns) <= nanoseconds_between(time_ns, after->time_ns);
    return recorded(earlier_is_nearer ? *before : *after);
  }
  if (!before && method != Method::kAfter) return error("no entry at or before {} ns", time_ns);
  if (!after && (method == Method::kAfter || method == Method::kLinear)) {
    return error("no entry at or after {} ns", time_ns);
  }
  switch (method) {
    case Method::kBefore:
      return recorded(*before);
    case Method::kAfter:
      return recorded(*after);
    case Method::kHold: {
      Reading reading = recorded(*before);
      if (before->time_ns != time_ns) reading.how = How::kHeld;
      reading.time_ns = time_ns;
      return reading;
    }
    default:
      return read_linear(*before, *after, time_ns, schema);
  }
}

std::string_view method_name(Method method) { return kMethodNames[static_cast<size_t>(method)]; }

Result<Method> parse_method(std::string_view name) {
  for (size_t i = 0; i < kMethodNames.size(); ++i) {
    if (kMethodNames[i] == name) return static_cast<Method>(i);
  }
  return error("method '{}': not one of latest, nearest, before, after, hold, linear", name);
}

std::string_view how_name(How how) {
  static constexpr std::array<std::string_view, 3> kNames = {"recorded", "interpolated", "held"};
  return kNames[static_cast<size_t>(how)];
}

}  // namespace sadb
