// Schema: what the entries of a path are. It is fixed once per path: by declare(), or by the first entry.
// Threads: values and functions without state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sadb/board/entry.h"
#include "silpose/base/result.h"

namespace sadb {

// One degree of freedom of a pose.
struct PoseDof {
  enum class Kind { kTranslation, kRotation, kShape };  // kShape: a property of the body, such as a bone's length

  std::string name;  // "root_tx"
  Kind kind = Kind::kRotation;
  std::string unit = "rad";  // of the values: "rad", "m"; for readers, not interpreted here
  double period = 0;         // in that unit: values that differ by whole periods are the same. 0: not periodic

  bool operator==(const PoseDof&) const = default;
};

struct PoseSchema {
  std::string skeleton;       // its name, that of every pose
  std::vector<PoseDof> dofs;  // [D] in the order of the values
  bool operator==(const PoseSchema&) const = default;
};

struct Schema {
  Type type = Type::kScalar;
  // Only for poses. Absent: poses of any skeleton and size are taken, and no value is periodic.
  std::optional<PoseSchema> pose = std::nullopt;
  bool operator==(const Schema&) const = default;
};

// Errors: DOF of a type other than pose; names of DOF that are empty or occur twice; a period below 0 or not finite.
silpose::Result<void> check_schema(const Schema& schema);

// Errors: says in which way the value contradicts the schema: type, skeleton, number of values.
silpose::Result<void> check_value(const Schema& schema, const Value& value);

}  // namespace sadb
