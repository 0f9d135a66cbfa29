#include "silpose/base/option_table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace silpose {
namespace {

enum class Fruit { kApple, kPear };

struct Basket {
  int count = 3;
  double weight_kg = 0.5;
  bool ripe = true, wrapped = false;
  Fruit fruit = Fruit::kPear;
  std::string name = "blue", label;
  std::optional<double> price;
  std::vector<std::string> owners;
  std::optional<std::array<double, 2>> range;
};

constexpr std::array<std::string_view, 2> kColours = {"blue", "red"};

const OptionTable<Basket>& table() {
  static const OptionTable<Basket> kTable = {
      "Baskets",
      {{"count", &Basket::count, between(1, 9), "How many"},
       {"weight-kg", &Basket::weight_kg, between(0, 2), "Each"},
       {"ripe", &Basket::ripe, "To be eaten now"},
       {"wrapped", &Basket::wrapped, {{"no", false}, {"yes", true}}, "In paper"},
       {"fruit", &Basket::fruit, {{"apple", Fruit::kApple}, {"pear", Fruit::kPear}}, "Which"},
       {"name", &Basket::name, words_from(kColours), "Colour"},
       {"label", &Basket::label, "Free text"},
       {"price", &Basket::price, between(0, 100), "Unset: not for sale"},
       {"owners", &Basket::owners, "Any number"},
       {"range", &Basket::range, between(-1, 1), "Low and high"}}};
  return kTable;
}

const OptionInfo& info(std::string_view name) { return table().find(name)->info; }

TEST(OptionTable, SetsWhatIsGivenAndLeavesTheRest) {
  GivenOptions given;
  for (const auto& [name, text] : std::map<std::string, std::string>{{"count", "7"},
                                                                     {"weight-kg", "1.25"},
                                                                     {"ripe", "false"},
                                                                     {"wrapped", "yes"},
                                                                     {"fruit", "apple"},
                                                                     {"price", "2"},
                                                                     {"owners", "a,b"},
                                                                     {"range", "-0.5,1"}}) {
    given[name] = parse_option(info(name), text).value();
  }
  Basket basket;
  table().apply(given, basket);
  EXPECT_EQ(basket.count, 7);
  EXPECT_EQ(basket.weight_kg, 1.25);
  EXPECT_FALSE(basket.ripe);
  EXPECT_TRUE(basket.wrapped);
  EXPECT_EQ(basket.fruit, Fruit::kApple);
  EXPECT_EQ(basket.name, "blue");
  EXPECT_EQ(basket.price, 2);
  EXPECT_EQ(basket.owners, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(basket.range, (std::array<double, 2>{-0.5, 1}));
}

TEST(OptionTable, CollectsWhatHasAValueAndReadsItBack) {
  Basket basket;
  basket.count = 4;
  basket.weight_kg = 0.1;
  basket.fruit = Fruit::kApple;
  GivenOptions values;
  table().collect(basket, values);
  EXPECT_FALSE(values.contains("price")) << "it is unset";
  EXPECT_EQ(text_of(values.at("count")), "4");
  EXPECT_EQ(text_of(values.at("weight-kg")), "0.1");
  EXPECT_EQ(text_of(values.at("ripe")), "true");
  EXPECT_EQ(text_of(values.at("wrapped")), "no");
  EXPECT_EQ(text_of(values.at("fruit")), "apple");
  for (auto& [name, value] : values) value = parse_option(info(name), text_of(value)).value();
  Basket again;
  table().apply(values, again);
  EXPECT_EQ(again.count, 4);
  EXPECT_EQ(again.weight_kg, 0.1);
  EXPECT_EQ(again.fruit, Fruit::kApple);
}

TEST(OptionTable, RefusalsSayTheValueAndWhatIsWanted) {
  const auto refusal = [](std::string_view name, const std::string& text) {
    return parse_option(info(name), text).error().message;
  };
  EXPECT_EQ(refusal("count", "0"), "0 is not a whole number from 1 to 9");
  EXPECT_EQ(refusal("count", "1.5"), "'1.5' is not a whole number from 1 to 9");
  EXPECT_EQ(refusal("count", "many"), "'many' is not a whole number from 1 to 9");
  EXPECT_EQ(refusal("weight-kg", "nan"), "'nan' is not a number from 0 to 2");
  EXPECT_EQ(refusal("weight-kg", "2.5"), "2.5 is not a number from 0 to 2");
  EXPECT_EQ(refusal("weight-kg", ""), "'' is not a number from 0 to 2");
  EXPECT_EQ(refusal("ripe", "maybe"), "'maybe' is not true or false");
  EXPECT_EQ(refusal("fruit", "plum"), "'plum' is not one of apple, pear");
  EXPECT_EQ(refusal("name", "green"), "'green' is not one of blue, red");
  EXPECT_EQ(refusal("range", "0"), "'0' is not two numbers from -1 to 1");
  EXPECT_EQ(refusal("range", "0,3"), "0,3 is not two numbers from -1 to 1");

  const auto misread = [](std::string_view name, const OptionValue& value) {
    return read_option(info(name), value).error().message;
  };
  EXPECT_EQ(misread("count", 2.0), "2 is not a whole number from 1 to 9");
  EXPECT_EQ(misread("ripe", int64_t{1}), "1 is not true or false");
  EXPECT_EQ(misread("owners", std::string("a")), "'a' is not a list of texts");
  EXPECT_EQ(misread("label", std::vector<std::string>{"a", "b"}), "[a,b] is not a text");
  EXPECT_EQ(read_option(info("weight-kg"), int64_t{1}).value(), OptionValue(1.0)) << "whole numbers are numbers, too";
}

TEST(OptionTable, CheckNamesTheOption) {
  const auto refusal = [](const Basket& basket) -> std::string {
    try {
      table().check(basket);
    } catch (const std::invalid_argument& wrong) {
      return wrong.what();
    }
    return "";
  };
  EXPECT_EQ(refusal({}), "");
  EXPECT_EQ(refusal({.count = 10}), "count: 10 is not a whole number from 1 to 9");
  EXPECT_EQ(refusal({.weight_kg = std::nan("")}), "weight-kg: nan is not a number from 0 to 2");
  EXPECT_EQ(refusal({.name = "green"}), "name: 'green' is not one of blue, red");
  EXPECT_EQ(refusal({.price = -1}), "price: -1 is not a number from 0 to 100");
}

TEST(OptionTable, OnlyWhatIsOffAsksForNothing) {
  EXPECT_EQ(info("ripe").off, OptionValue(false));
  EXPECT_EQ(info("wrapped").off, OptionValue(std::string("no")));
  EXPECT_FALSE(info("fruit").off.has_value());
  EXPECT_EQ(table().find("basket"), nullptr);
}

TEST(OptionNames, AreKeysWithUnderscores) {
  EXPECT_EQ(with_underscores("resample-below"), "resample_below");
  EXPECT_EQ(with_dashes("resample_below"), "resample-below");
}

}  // namespace
}  // namespace silpose
