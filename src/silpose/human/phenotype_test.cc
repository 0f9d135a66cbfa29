#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "silpose/human/human.h"

namespace silpose {
namespace {

using testing::HasSubstr;

TEST(ParsePhenotype, ReadsAllKeys) {
  const Phenotype p = parse_phenotype("human:age=30,sex=f,height=1.62,weight=58,muscle=0.6,dof=36").value();
  EXPECT_EQ(p.age_years, 30);
  EXPECT_EQ(p.sex, 1);
  EXPECT_EQ(p.height_m, 1.62);
  EXPECT_EQ(p.weight_kg, 58);
  EXPECT_EQ(p.muscle, 0.6);
}

TEST(ParsePhenotype, HasDefaults) {
  const Phenotype p = parse_phenotype("human").value();
  EXPECT_EQ(p.age_years, 25);
  EXPECT_EQ(p.sex, 0.5);
  EXPECT_FALSE(p.height_m);
  EXPECT_FALSE(p.weight_kg);
  EXPECT_EQ(parse_phenotype("human:sex=m").value().sex, 0);
  EXPECT_EQ(parse_phenotype("human:sex=0.25").value().sex, 0.25);
}

TEST(StatureDeviation, IsOfThoseWhoAreMeant) {
  const auto of = [](const char* text) { return stature_deviation(parse_phenotype(text).value()); };
  EXPECT_EQ(of("human:height=1.7"), 0);
  EXPECT_NEAR(of("human:sex=m"), 0.042, 1e-9);
  EXPECT_NEAR(of("human:sex=f,age=60"), 0.042, 1e-9);
  EXPECT_NEAR(of("human"), 0.058, 1e-3) << "9.5 cm of 1.67 m";
}

TEST(ParsePhenotype, NamesTheBadKey) {
  for (const auto& [text, named] : {std::pair{"human:tail=1", "tail"},
                                    {"human:age=12", "age"},
                                    {"human:age=old", "age"},
                                    {"human:age=30x", "age"},
                                    {"human:age=", "age"},
                                    {"human:height=nan", "height"},
                                    {"human:height=-1", "height"},
                                    {"human:sex=x", "sex"},
                                    {"human:age=30,age=31", "age"},
                                    {"human:age", "KEY=VALUE"},
                                    {"humanoid", "humanoid"},
                                    {"snake:12", "snake"}}) {
    const Result<Phenotype> p = parse_phenotype(text);
    ASSERT_FALSE(p) << text;
    EXPECT_THAT(p.error().message, HasSubstr(named));
  }
}

}  // namespace
}  // namespace silpose
