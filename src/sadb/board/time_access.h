// Time access: the value of a path at an instant, by the method that the reader chooses. Every store finds the
// neighbours of the instant in its own way; the value is computed from them here.
// Threads: functions without state.
#pragma once

#include <cstdint>
#include <string_view>

#include "sadb/board/entry.h"
#include "sadb/board/schema.h"
#include "silpose/base/result.h"

namespace sadb {

enum class Method {
  kLatest,   // the last entry of all; the instant does not matter
  kNearest,  // the entry nearest in time, the earlier of equals
  kBefore,   // the last entry at or before the instant
  kAfter,    // the first entry at or after the instant
  kHold,     // what was in force at the instant: the value at or before it, however long ago
  kLinear,   // between the neighbours: numbers, vectors and poses value by value, transforms by slerp; an entry at the
             // very instant serves every type. Periodic values of a pose (schema.h) go the shorter way: between 179
             // and -179 degrees lies 180. They continue from the earlier neighbour, so they may end up outside the
             // interval that a writer keeps to: 181 degrees, not -179. Of two equally short ways, that of the numbers.
};

// How a value is to be read. Designated initialisers: read_at(n, t, {.method = Method::kLinear}, schema).
struct TimeAccess {
  Method method = Method::kLatest;
};

// How a reading was obtained. What goes beyond the entries (extrapolation, with a bound on its error) will be a further
// kind with further fields of Reading.
enum class How {
  kRecorded,      // an entry's own value
  kInterpolated,  // computed from the entries at from_ns and to_ns, which are before and after the instant
  kHeld,          // the value of the entry at from_ns, still in force
};

struct Reading {
  Value value;
  int64_t time_ns = 0;  // the entry's own for a recorded value, else the instant asked for
  How how = How::kRecorded;
  int64_t from_ns = 0, to_ns = 0;  // times of the first and the last entry that went into it
};

// The entries about an instant; null where there is none. The pointed-to entries belong to the caller.
struct Neighbours {
  const Entry* at_or_before = nullptr;
  const Entry* at_or_after = nullptr;
  const Entry* latest = nullptr;
};

// `schema` is that of the path; the entries conform to it (check_value()).
// Errors: no entry on the side that the method needs; a type that cannot be interpolated; neighbours that do not fit
// together (lengths of vectors, skeletons of poses).
silpose::Result<Reading> read_at(const Neighbours& neighbours, int64_t time_ns, TimeAccess access,
                                 const Schema& schema);

// "latest", "nearest", "before", "after", "hold", "linear"; and back. Errors: a name that is unknown or not built.
[[nodiscard]] std::string_view method_name(Method method);
silpose::Result<Method> parse_method(std::string_view name);

// "recorded", "interpolated", "held".
[[nodiscard]] std::string_view how_name(How how);

}  // namespace sadb
