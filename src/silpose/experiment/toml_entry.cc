#include "silpose/experiment/toml_entry.h"

#include <array>
#include <utility>

namespace silpose {

Result<std::string> text_of(const TomlEntry& entry) {
  if (const auto text = entry.node.value_exact<std::string>()) return *text;
  return error("{}: a text is wanted", entry.where);
}

Result<bool> flag_of(const TomlEntry& entry) {
  if (const auto flag = entry.node.value_exact<bool>()) return *flag;
  return error("{}: true or false is wanted", entry.where);
}

Result<int> integer_of(const TomlEntry& entry, int low, int high) {
  if (const auto value = entry.node.value_exact<int64_t>(); value && *value >= low && *value <= high) {
    return static_cast<int>(*value);
  }
  return error("{}: a whole number from {} to {} is wanted", entry.where, low, high);
}

Result<std::vector<std::string>> texts_of(const TomlEntry& entry) {
  const toml::array* const array = entry.node.as_array();
  if (array == nullptr) return error("{}: a list of texts is wanted", entry.where);
  std::vector<std::string> texts;
  for (const toml::node& element : *array) {
    const auto text = element.value_exact<std::string>();
    if (!text) return error("{}: a list of texts is wanted", entry.where);
    texts.push_back(*text);
  }
  return texts;
}

Result<OptionValue> value_of(const TomlEntry& entry) {
  const toml::node& node = entry.node;
  if (const auto flag = node.value_exact<bool>()) return OptionValue(*flag);
  if (const auto whole = node.value_exact<int64_t>()) return OptionValue(*whole);
  if (const auto number = node.value_exact<double>()) return OptionValue(*number);
  if (const auto text = node.value_exact<std::string>()) return OptionValue(*text);
  const toml::array* const array = node.as_array();
  if (array == nullptr) return error("{}: not a plain value or a list", entry.where);
  if (array->size() == 2 && (*array)[0].is_number() && (*array)[1].is_number()) {
    return OptionValue(std::array{*(*array)[0].value<double>(), *(*array)[1].value<double>()});
  }
  Result<std::vector<std::string>> texts = texts_of(entry);
  if (!texts) return error("{}: a list of texts or two numbers is wanted", entry.where);
  return OptionValue(*std::move(texts));
}

}  // namespace silpose
