#include "sadb/board/schema.h"

#include <cmath>
#include <set>

namespace sadb {

using silpose::error;
using silpose::Result;

Result<void> check_schema(const Schema& schema) {
  if (!schema.pose) return {};
  if (schema.type != Type::kPose) return error("type {} has no degrees of freedom", type_name(schema.type));
  std::set<std::string> names;
  for (const PoseDof& dof : schema.pose->dofs) {
    if (dof.name.empty()) return error("a degree of freedom without a name");
    if (!names.insert(dof.name).second) return error("two degrees of freedom are called {}", dof.name);
    if (!std::isfinite(dof.period) || dof.period < 0) return error("{}: a period of {}", dof.name, dof.period);
  }
  return {};
}

Result<void> check_value(const Schema& schema, const Value& value) {
  if (type_of(value) != schema.type) {
    return error("is of type {}, not {}", type_name(schema.type), type_name(type_of(value)));
  }
  if (!schema.pose) return {};
  const Pose& pose = std::get<Pose>(value);
  if (pose.skeleton != schema.pose->skeleton) {
    return error("is of skeleton '{}', not '{}'", schema.pose->skeleton, pose.skeleton);
  }
  if (pose.values.size() != schema.pose->dofs.size()) {
    return error("poses have {} values, not {}", schema.pose->dofs.size(), pose.values.size());
  }
  return {};
}

}  // namespace sadb
