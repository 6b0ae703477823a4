#include "core/expression.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace lacuna {
namespace {

const std::vector<std::string> kNames{"x", "y", "stiffness"};

double ValueOf(const std::string& text, double x = 0, double y = 0, double stiffness = 0) {
  const double values[] = {x, y, stiffness};
  return Expression(text, kNames).At(values);
}

TEST(Expression, ReadsNumbersAndConstants) {
  EXPECT_EQ(ValueOf("12"), 12);
  EXPECT_EQ(ValueOf(".5"), 0.5);
  EXPECT_EQ(ValueOf(" 1e-3 "), 1e-3);
  EXPECT_EQ(ValueOf("2.E2"), 200);
  EXPECT_EQ(ValueOf("pi"), std::numbers::pi);
}

TEST(Expression, FollowsMathematicalPrecedence) {
  EXPECT_EQ(ValueOf("1 + 2 * 3"), 7);
  EXPECT_EQ(ValueOf("(1 + 2) * 3"), 9);
  EXPECT_EQ(ValueOf("10 - 4 - 3"), 3);
  EXPECT_EQ(ValueOf("24 / 4 / 3"), 2);
  EXPECT_EQ(ValueOf("24 / 4 * 3"), 18);
  EXPECT_EQ(ValueOf("2 ^ 3 ^ 2"), 512);
  EXPECT_EQ(ValueOf("2 * 3 ^ 2"), 18);
  EXPECT_EQ(ValueOf("-3 ^ 2"), -9);
  EXPECT_EQ(ValueOf("-x ^ 2", 3), -9);
  EXPECT_EQ(ValueOf("(-3) ^ 2"), 9);
  EXPECT_EQ(ValueOf("2 ^ -1"), 0.5);
  EXPECT_EQ(ValueOf("2 ^ -x ^ 2", 2), 1.0 / 16);
  EXPECT_EQ(ValueOf("3 - -2"), 5);
  EXPECT_EQ(ValueOf("--+2"), 2);
  EXPECT_EQ(ValueOf("-2 * -3"), 6);
  EXPECT_EQ(ValueOf("x - y * stiffness / 2", 1, 2, 3), -2);
}

TEST(Expression, EvaluatesItsFunctions) {
  const double x = 0.3, y = -0.7;
  EXPECT_EQ(ValueOf("sin(x) + cos(y) + tan(x)", x, y), std::sin(x) + std::cos(y) + std::tan(x));
  EXPECT_EQ(ValueOf("asin(x) + acos(y) + atan(x)", x, y),
            std::asin(x) + std::acos(y) + std::atan(x));
  EXPECT_EQ(ValueOf("exp(x) * log(x) * sqrt(x)", x), std::exp(x) * std::log(x) * std::sqrt(x));
  EXPECT_EQ(ValueOf("atan2(y, x)", x, y), std::atan2(y, x));
  EXPECT_EQ(ValueOf("abs(y) + tanh(x)", x, y), std::abs(y) + std::tanh(x));
  EXPECT_EQ(ValueOf("min(x, y)", x, y), y);
  EXPECT_EQ(ValueOf("max(x, y)", x, y), x);
  EXPECT_EQ(ValueOf("pow(x, 3)", x), std::pow(x, 3));
  EXPECT_EQ(ValueOf("step(x)", -1e-9), 0);
  EXPECT_EQ(ValueOf("step(x)", 0), 1);
  EXPECT_EQ(ValueOf("smooth_step(x)", -1), 0);
  EXPECT_EQ(ValueOf("smooth_step(x)", 0.25), 3.0 / 16 - 2.0 / 64);
  EXPECT_EQ(ValueOf("smooth_step(x)", 2), 1);
}

TEST(Expression, ReportsWhichVariablesItUses) {
  const Expression expression("y * 0 + sin(pi)", kNames);
  EXPECT_FALSE(expression.Uses(0));
  EXPECT_TRUE(expression.Uses(1));
  EXPECT_EQ(expression.text(), "y * 0 + sin(pi)");
}

TEST(Expression, IsNotFiniteWhereItIsUndefined) {
  for (const char* text :
       {"log(x)", "sqrt(x)", "x ^ 0.5", "asin(x - 1)", "min(log(x), 1)", "min(1, log(x))",
        "max(log(x), 1)", "max(1, log(x))", "abs(log(x))", "step(log(x))", "smooth_step(log(x))"}) {
    EXPECT_TRUE(std::isnan(ValueOf(text, -1))) << text;
  }
  EXPECT_EQ(ValueOf("1 / x", 0), std::numeric_limits<double>::infinity());
}

// The smallest deviation of the derivative from central differences over several step sizes.
double DerivativeError(const std::string& text, const std::array<double, 3>& at) {
  const Expression expression(text, kNames);
  Dual<3> variables[3];
  for (int k = 0; k < 3; ++k) variables[k] = Dual<3>::Variable(at[k], k);
  const Dual<3> result = expression.At(variables);
  EXPECT_EQ(result.value, expression.At(at.data())) << text;
  double worst = 0;
  for (int k = 0; k < 3; ++k) {
    double best = std::numeric_limits<double>::infinity();
    for (const double h : {1e-3, 1e-4, 1e-5}) {
      std::array<double, 3> above = at, below = at;
      above[k] += h;
      below[k] -= h;
      const double difference =
          (expression.At(above.data()) - expression.At(below.data())) / (2 * h);
      best = std::min(best, std::abs(difference - result.derivative[k]));
    }
    worst = std::max(worst, best / std::max(1.0, result.derivative.matrix().norm()));
    Dual<1> along[3];
    for (int j = 0; j < 3; ++j)
      along[j] = j == k ? Dual<1>::Variable(at[j], 0) : Dual<1>::Constant(at[j]);
    EXPECT_EQ(expression.At(along).derivative[0], result.derivative[k]) << text;
  }
  return worst;
}

TEST(Expression, HasDerivativesThatMatchFiniteDifferences) {
  for (const char* text : {"x + 2*y - stiffness",
                           "x*y*stiffness",
                           "x/y + y/x",
                           "-stiffness * exp(-(x - 0.1)/y)",
                           "x^3",
                           "x^2",
                           "x^-2",
                           "2^x",
                           "x^y",
                           "pow(x*y, stiffness)",
                           "(-x)^3",
                           "x^0",
                           "0^x",
                           "sin(x*y)",
                           "cos(x*y)",
                           "tan(x*y)",
                           "asin(x*y)",
                           "acos(x*y)",
                           "atan(x/y)",
                           "atan2(x, y)",
                           "atan2(-x, -y)",
                           "exp(x*y)",
                           "log(x/y)",
                           "sqrt(x + y)",
                           "abs(x - y)",
                           "abs(y - x)",
                           "tanh(x*stiffness)",
                           "min(x^2, y)",
                           "max(x^2, y)",
                           "min(y, x^2)",
                           "step(x) * y",
                           "smooth_step(x)",
                           "smooth_step(y/x)",
                           "smooth_step(-x)",
                           "x/sqrt(x^2 + y^2)"}) {
    // Central differences with steps of 1e-4 to 1e-5 have a truncation error of up to 1e-8 and a
    // rounding error of 1e-11.
    EXPECT_LT(DerivativeError(text, {0.6, 0.9, 1.7}), 2e-8) << text;
  }
}

TEST(Expression, HasFiniteDerivativesWhereTheArgumentIsConstant) {
  const auto derivative = [](const std::string& text, double x, double y) {
    const Dual<3> variables[] = {Dual<3>::Variable(x, 0), Dual<3>::Variable(y, 1),
                                 Dual<3>::Constant(0)};
    return Expression(text, kNames).At(variables).derivative;
  };
  // The norm of a zero vector; a negative base with a constant exponent; a root of a constant.
  EXPECT_EQ(derivative("sqrt(x^2 + y^2)", 0, 0).matrix().norm(), 0);
  EXPECT_EQ(derivative("x^3", -2, 0)[0], 12);
  EXPECT_EQ(derivative("x^2", -2, 0)[0], -4);
  EXPECT_EQ(derivative("x^0", 0, 0)[0], 0);
  EXPECT_EQ(derivative("sqrt(x) + y", 0, 0)[1], 1);
  EXPECT_EQ(derivative("abs(x)", 0, 0)[0], 0);
}

std::string ErrorOf(const std::string& text) {
  try {
    const Expression expression(text, kNames);
  } catch (const ExpressionError& problem) {
    EXPECT_EQ(std::string(problem.what()).find(fmt::format("column {}: ", problem.column())), 0u);
    return problem.what();
  }
  return "nothing was refused";
}

TEST(Expression, ReportsErrorsWithTheirColumn) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "column 1: the formula is empty"},
      {"  ", "column 1: the formula is empty"},
      {"x + ", "column 5: expected a value, but the formula ends"},
      {"(x + 1", "column 7: missing \")\" for the \"(\" in column 1"},
      {"sin(x", "column 6: missing \")\" for the \"(\" in column 4"},
      {"x + 1)", "column 6: unexpected \")\""},
      {"x * / y", "column 5: expected a value, got \"/\""},
      {"()", "column 2: expected a value, got \")\""},
      {"x ** 2", "column 3: write a power with \"^\", as in x^2"},
      {"2 x", "column 3: expected an operator before \"x\""},
      {"x 2", "column 3: expected an operator before \"2\""},
      {"(x)(y)", "column 4: expected an operator before \"(\""},
      {"x(2)", "column 2: x is not a function; write a product with \"*\""},
      {"pi(2)", "column 3: pi is not a function; write a product with \"*\""},
      {"x > 2", "column 3: unknown operator \">\"; write a condition with step(...)"},
      {"0,02 * x",
       "column 2: unexpected \",\" outside the arguments of a function; the decimal separator must "
       "be a point"},
      {"3 * stifness", "column 5: unknown name \"stifness\"; did you mean \"stiffness\"?"},
      {"snh(x)", "column 1: unknown function \"snh\"; did you mean \"sin\"?"},
      {"qqqqqq", "column 1: unknown name \"qqqqqq\""},
      {"1 + sin", "column 5: sin is a function; write sin(...)"},
      {"min + 1", "column 1: min is a function; write min(..., ...)"},
      {"y + min(x)", "column 5: min takes 2 arguments, got 1"},
      {"sin(x, y)", "column 1: sin takes 1 argument, got 2"},
      {"sin()", "column 1: sin takes 1 argument, got 0"},
      {"x + .", "column 5: expected digits before or after the \".\""},
      {"1e999", "column 1: the number is out of range"},
      {"x + log(-1) ", "column 5: the value of the subexpression that starts here is not finite"},
      {"x + 1 / (2 - 2)",
       "column 5: the value of the subexpression that starts here is not finite"},
      {"x − y", "column 3: unexpected \"−\""},
      {"−x · y", "column 1: expected a value, got \"−\""},
      {"π²", "column 1: expected a value, got \"π\""},
      {"x\u00b2 + $", "column 2: unexpected \"²\""},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(ErrorOf(text), message) << text;
}

TEST(Expression, RefusesTooDeepNesting) {
  EXPECT_EQ(ValueOf(std::string(100, '(') + "1" + std::string(100, ')')), 1);
  const std::string values = [] {
    std::string text;
    for (int k = 0; k < 100; ++k) text += "x + (";
    return text + "x" + std::string(100, ')');
  }();
  for (const std::string& text : {std::string(100000, '('), std::string(100000, '-') + "x", values})
    EXPECT_THAT(ErrorOf(text), testing::HasSubstr("is nested too deeply"));
  // A long expression is not a deep one.
  std::string sum = "x";
  for (int k = 0; k < 10000; ++k) sum += " + x";
  EXPECT_EQ(ValueOf(sum, 1), 10001);
}

TEST(Expression, SurvivesRandomText) {
  const std::string alphabet = "xy12.+-*/^(),sincoexpmin e\xc2\xb2_";
  std::mt19937 random(3);
  int sound = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text;
    for (unsigned length = random() % 12; length > 0; --length)
      text += alphabet[random() % alphabet.size()];
    try {
      ValueOf(text, 0.5, 2);
      ++sound;
    } catch (const ExpressionError& problem) {
      EXPECT_GE(problem.column(), 1) << text;
      EXPECT_LE(problem.column(), static_cast<int>(text.size()) + 1) << text;
    }
  }
  EXPECT_GT(sound, 100);
}

TEST(Expression, RecognisesValidNames) {
  for (const char* name : {"k", "z0", "_a", "stiffNess_2"}) EXPECT_TRUE(Expression::IsName(name));
  for (const char* name : {"", "2k", "a-b", "a b", "µ"}) EXPECT_FALSE(Expression::IsName(name));
}

}  // namespace
}  // namespace lacuna
