#include <charconv>
#include <cmath>
#include <set>

#include "silpose/human/human.h"

namespace silpose {
namespace {

Result<double> parse_in_range(std::string_view key, std::string_view text, double lower, double upper) {
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return error("{}: '{}' is not a number", key, text);
  }
  if (value < lower || value > upper) return error("{}: {} is not within {} to {}", key, text, lower, upper);
  return value;
}

}  // namespace

Result<Phenotype> parse_phenotype(const std::string& text) {
  Phenotype phenotype;
  std::string_view rest = text;
  constexpr std::string_view kName = "human";
  if (!rest.starts_with(kName) || (rest.size() > kName.size() && rest[kName.size()] != ':')) {
    return error("'{}': not a human body (human:age=30,sex=f,height=1.62,weight=58,muscle=0.5)", text);
  }
  rest.remove_prefix(std::min(rest.size(), kName.size() + 1));
  std::set<std::string_view> seen;
  while (!rest.empty()) {
    const size_t comma = std::min(rest.find(','), rest.size());
    const std::string_view item = rest.substr(0, comma);
    rest.remove_prefix(std::min(rest.size(), comma + 1));
    const size_t equals = item.find('=');
    if (equals == std::string_view::npos) return error("'{}': '{}' is not KEY=VALUE", text, item);
    const std::string_view key = item.substr(0, equals), value = item.substr(equals + 1);
    if (!seen.insert(key).second) return error("{}: given twice", key);
    Result<double> number = 0.0;
    if (key == "age") {
      number = parse_in_range(key, value, 18, 90);
      if (number) phenotype.age_years = *number;
    } else if (key == "sex") {
      if (value != "f" && value != "m") number = parse_in_range(key, value, 0, 1);
      if (number) phenotype.sex = value == "f" ? 1 : value == "m" ? 0 : *number;
    } else if (key == "height") {
      number = parse_in_range(key, value, 0.5, 3);
      if (number) phenotype.height_m = *number;
    } else if (key == "weight") {
      number = parse_in_range(key, value, 10, 500);
      if (number) phenotype.weight_kg = *number;
    } else if (key == "muscle") {
      number = parse_in_range(key, value, 0, 1);
      if (number) phenotype.muscle = *number;
    } else if (key != "dof") {  // dof= is the caller's
      return error("{}: unknown; a human has age, sex, height, weight, muscle, dof", key);
    }
    if (!number) return number.failure();
  }
  return phenotype;
}

double stature_deviation(const Phenotype& phenotype) {
  if (phenotype.height_m) return 0;
  constexpr double kOfOneSex = 0.042, kBetweenSexes = 0.04;  // either sex's mean from that of both
  return std::hypot(kOfOneSex, 2 * kBetweenSexes * std::sqrt(phenotype.sex * (1 - phenotype.sex)));
}

}  // namespace silpose
