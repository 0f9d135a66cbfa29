#include "sadb/board/entry.h"

#include <array>

namespace sadb {

std::string_view type_name(Type type) {
  static constexpr std::array<std::string_view, 8> kNames = {"scalar",    "vector", "text",  "json",
                                                             "transform", "pose",   "image", "mask"};
  static_assert(std::variant_size_v<Value> == kNames.size());
  return kNames[static_cast<size_t>(type)];
}

}  // namespace sadb
