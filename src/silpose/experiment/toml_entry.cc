#include "silpose/experiment/toml_entry.h"

#include <algorithm>
#include <cmath>

namespace silpose {

Result<std::string> text_of(const TomlEntry& entry) {
  if (const auto text = entry.node.value_exact<std::string>()) return *text;
  return error("{}: a text is wanted", entry.where);
}

Result<bool> flag_of(const TomlEntry& entry) {
  if (const auto flag = entry.node.value_exact<bool>()) return *flag;
  return error("{}: true or false is wanted", entry.where);
}

Result<double> number_of(const TomlEntry& entry, double low, double high) {
  if (const auto value = entry.node.is_number() ? entry.node.value<double>() : std::nullopt) {
    if (std::isfinite(*value) && *value >= low && *value <= high) return *value;
  }
  return error("{}: a number from {:g} to {:g} is wanted", entry.where, low, high);
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

Result<std::array<double, 2>> pair_of(const TomlEntry& entry, double low, double high) {
  const toml::array* const array = entry.node.as_array();
  if (array == nullptr || array->size() != 2) return error("{}: two numbers are wanted", entry.where);
  std::array<double, 2> pair{};
  for (size_t i = 0; i < 2; ++i) {
    const Result<double> number = number_of({(*array)[i], entry.where}, low, high);
    if (!number) return number.failure();
    pair[i] = *number;
  }
  return pair;
}

Result<std::string> word_of(const TomlEntry& entry, std::initializer_list<std::string_view> words) {
  const Result<std::string> text = text_of(entry);
  if (!text) return text.failure();
  if (std::find(words.begin(), words.end(), *text) == words.end()) {
    return error("{}: '{}' is not one of {}", entry.where, *text, fmt::join(words, ", "));
  }
  return *text;
}

}  // namespace silpose
