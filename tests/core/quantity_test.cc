#include "core/quantity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>

namespace lacuna {
namespace {

TEST(Quantity, ConvertsUnitsToSi) {
  EXPECT_DOUBLE_EQ(ParseQuantity("0.1 MPa", kPressure), 1e5);
  EXPECT_DOUBLE_EQ(ParseQuantity("30 mm", kLength), 0.03);
  EXPECT_DOUBLE_EQ(ParseQuantity("30mm", kLength), 0.03);
  EXPECT_DOUBLE_EQ(ParseQuantity("12 Pa s", kViscosity), 12);
  EXPECT_DOUBLE_EQ(ParseQuantity("12 Pa*s", kViscosity), 12);
  EXPECT_DOUBLE_EQ(ParseQuantity("12 N s/m^2", kViscosity), 12);
  EXPECT_DOUBLE_EQ(ParseQuantity("1.07 g/cm^3", kDensity), 1070);
  EXPECT_DOUBLE_EQ(ParseQuantity("1.07 g/cm³", kDensity), 1070);
  EXPECT_DOUBLE_EQ(ParseQuantity("1070 kg m^-3", kDensity), 1070);
  EXPECT_DOUBLE_EQ(ParseQuantity("-9.81 m/s2", kAcceleration), -9.81);
  EXPECT_DOUBLE_EQ(ParseQuantity("180 deg", kAngle), std::numbers::pi);
  EXPECT_DOUBLE_EQ(ParseQuantity("2 min", kTime), 120);
  EXPECT_EQ(ParseQuantity("0", kTime), 0);
  EXPECT_EQ(ParseQuantity("0.00", kLength), 0);
  EXPECT_DOUBLE_EQ(ParseQuantity("5 µm", kLength), 5e-6);
  EXPECT_DOUBLE_EQ(ParseQuantity("1e-4", kDimensionless), 1e-4);
  EXPECT_DOUBLE_EQ(ParseQuantity("25 %", kDimensionless), 0.25);
  EXPECT_DOUBLE_EQ(ParseQuantity("2 kgf", kForce), 19.6133);
  EXPECT_DOUBLE_EQ(ParseQuantity("3 daN", kForce), 30);
  EXPECT_NEAR(ParseQuantity("1 lbf", kForce), 4.448222, 1e-6);
  EXPECT_DOUBLE_EQ(ParseQuantity("4 msec", kTime), 4e-3);
  for (const char* torque : {"2 mNm", "2 mN m", "2 mN.m", "2 Nmm"})
    EXPECT_DOUBLE_EQ(ParseAnyQuantity(torque).value, 2e-3) << torque;
}

void ExpectRefused(const char* text, const Dimension& dimension, const char* part) {
  try {
    const double value = ParseQuantity(text, dimension);
    ADD_FAILURE() << "\"" << text << "\" was read as " << value;
  } catch (const std::invalid_argument& problem) {
    EXPECT_THAT(problem.what(), testing::HasSubstr(part));
  }
}

TEST(Quantity, RefusesInvalidTextAndSaysWhatWasExpected) {
  ExpectRefused("12 Pas", kViscosity, "expected a viscosity, e.g. \"12 Pa s\"");
  ExpectRefused("30", kLength, "a unit is missing");
  ExpectRefused("0 kg", kLength, "another dimension");
  ExpectRefused("30 kg", kLength, "another dimension");
  ExpectRefused("30 mmm", kLength, "unknown unit \"mmm\"");
  ExpectRefused("30 mm extra", kLength, "unknown unit \"extra\"");
  ExpectRefused("m", kLength, "expected a length");
  ExpectRefused("", kLength, "expected a length");
  ExpectRefused("nan mm", kLength, "not a finite number");
  ExpectRefused("1e999 mm", kLength, "expected a length");
  ExpectRefused("3 m/", kVelocity, "must follow \"/\"");
  ExpectRefused("3 m//s", kVelocity, "must follow \"/\"");
  ExpectRefused("3 m*", kLength, "must follow \"*\"");
  ExpectRefused("+-3 m", kLength, "+-3 m");
  ExpectRefused("3 m^x", kArea, "must follow \"^\"");
  ExpectRefused("3 kmin", kTime, "unknown unit");  // a minute takes no prefix
}

TEST(Quantity, SaysHowANumberWithADecimalCommaIsWritten) {
  ExpectRefused("0,2 mm", kLength,
                "got \"0,2 mm\" (the decimal separator must be a point: \"0.2 mm\"); expected a "
                "length");
  ExpectRefused("-12,50 mm", kLength, "point: \"-12.50 mm\"");
  ExpectRefused("0,05", kDimensionless, "point: \"0.05\"");
  ExpectRefused(",5 mm", kLength, "point: \".5 mm\"");
  try {
    ParseAnyQuantity("0,2 N/kg");
    ADD_FAILURE() << "nothing was refused";
  } catch (const std::invalid_argument& problem) {
    EXPECT_THAT(problem.what(), testing::HasSubstr("point: \"0.2 N/kg\""));
  }
  ExpectRefused("1,234.5 mm", kLength, "(unknown unit \",\")");
  ExpectRefused("1,", kDimensionless, "(unknown unit \",\")");
  ExpectRefused("0, mm", kLength, "(unknown unit \",\")");
}

TEST(Quantity, DeterminesTheDimensionOfAnyUnit) {
  const MeasuredQuantity pull = ParseAnyQuantity("3 N/kg");
  EXPECT_DOUBLE_EQ(pull.value, 3);
  EXPECT_TRUE(pull.dimension.SameAs(kAcceleration));
  EXPECT_STREQ(pull.dimension.unit, "m/s^2");
  const MeasuredQuantity odd = ParseAnyQuantity("-2 mN s/mm^4");
  EXPECT_DOUBLE_EQ(odd.value, -2e9);
  EXPECT_STREQ(odd.dimension.unit, "kg/m^3/s");
  EXPECT_STREQ(odd.dimension.name, "a quantity in kg/m^3/s");
  // The example text of a dimension can be parsed again.
  EXPECT_TRUE(ParseAnyQuantity(odd.dimension.example).dimension.SameAs(odd.dimension));
  EXPECT_TRUE(ParseAnyQuantity("0.5").dimension.SameAs(kDimensionless));
  EXPECT_TRUE(ParseAnyQuantity("4 1/mm^2").dimension.SameAs({-2, 0, 0, 0, 0}));
  for (const char* text : {"", "m", "3 mmm", "nan s", "3 m/"}) {
    EXPECT_THROW(ParseAnyQuantity(text), std::invalid_argument) << text;
  }
}

TEST(Quantity, FindsUnitsInAnyCase) {
  using testing::ElementsAre;
  using testing::UnorderedElementsAre;
  EXPECT_THAT(UnitsInAnyCase("KN", kForce), ElementsAre("kN"));
  EXPECT_THAT(UnitsInAnyCase("mn", kForce), UnorderedElementsAre("mN", "MN"));
  EXPECT_THAT(UnitsInAnyCase("Deg", kAngle), ElementsAre("deg"));
  EXPECT_TRUE(UnitsInAnyCase("KN", kLength).empty());
  EXPECT_TRUE(UnitsInAnyCase("cell 1", kForce).empty());
}

TEST(Quantity, AnEpochIsWrittenToTheMillisecond) {
  EXPECT_EQ(TimeText(0.25), "0.25 s");
  EXPECT_EQ(TimeText(1.7e9 + 1.15), "1700000001.15 s");
}

TEST(Quantity, ATimeIsWrittenInMillisecondsBelowASecond) {
  EXPECT_EQ(DurationText(0.0025), "2.5 ms");
  EXPECT_EQ(DurationText(1), "1 s");
}

}  // namespace
}  // namespace lacuna
