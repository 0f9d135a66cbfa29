#include "silpose/base/levenberg_marquardt.h"

#include <gtest/gtest.h>

#include <vector>

namespace silpose {
namespace {

// cost(x) = (x^2 - 2)^2: Gauss-Newton's r = x^2 - 2, J = 2 x.
struct Root {
  double x = 0;
  [[nodiscard]] double cost() const { return (x * x - 2) * (x * x - 2); }
};

Root gauss_newton(const Root& at, double damping) {
  const double J = 2 * at.x;
  return {at.x - J * (at.x * at.x - 2) / (J * J * (1 + damping))};
}

TEST(Descend, FindsTheMinimum) {
  Root at{0.3};  // the first whole step overshoots to 3.5
  levenberg_marquardt(at, 40, {.absolute = 1e-20},
                      [](const Root& from, double damping) { return std::optional(gauss_newton(from, damping)); });
  EXPECT_NEAR(at.x, std::sqrt(2.0), 1e-9);
}

TEST(Descend, NeverGoesUpAndDampsMoreUntilItNeedNot) {
  Root at{0.3};
  std::vector<double> tried;
  double last = at.cost();
  levenberg_marquardt(at, 6, {}, [&](const Root& from, double damping) {
    EXPECT_LE(from.cost(), last);
    last = from.cost();
    tried.push_back(damping);
    return std::optional(gauss_newton(from, damping));
  });
  ASSERT_EQ(tried.size(), 6u);
  EXPECT_EQ(tried[0], 1e-3);
  EXPECT_EQ(tried[1], 8e-3);  // 3.5 is worse than 0.3
}

TEST(Descend, EndsWhereTheGainIsSmallOrTheStepIsNone) {
  Root at{1.4142};
  int steps = 0;
  const auto count = [&](const Root& from, double damping) {
    ++steps;
    return std::optional(gauss_newton(from, damping));
  };
  levenberg_marquardt(at, 40, {.absolute = 1e-3}, count);
  EXPECT_EQ(steps, 1);
  at.x = 1.4;
  levenberg_marquardt(at, 40, {.relative = 1e9}, count);
  EXPECT_EQ(steps, 2);
  at.x = 1.3;
  levenberg_marquardt(at, 40, {}, [](const Root&, double) { return std::optional<Root>(); });
  EXPECT_EQ(at.x, 1.3);
}

}  // namespace
}  // namespace silpose
