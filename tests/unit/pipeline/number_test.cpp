#include "pipeline/number.hpp"

#include <clocale>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace grainvdb::number_test {
namespace {

TEST(ParseNumber, TakesDecimalForms) {
  EXPECT_EQ(parse_number("0.4e-3"), 0.4e-3);
  EXPECT_EQ(parse_number("+2.5"), 2.5);
  EXPECT_EQ(parse_number("-.5"), -0.5);
  EXPECT_EQ(parse_number("3."), 3.0);
  EXPECT_EQ(parse_number("1E3"), 1000.0);
  EXPECT_EQ(parse_number(".inf"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_number("-.inf"), -std::numeric_limits<double>::infinity());
}

TEST(ParseNumber, WantsTheWholeText) {
  for (const char* text : {"",         " 1",    "1 ",  "1.5e", "0.4mm", "1,5", "0x10", "nan",   ".nan", "inf", "-inf",
                           "infinity", "1e999", "--1", "+-1",  "+",     "-",   ".",    "1_000", "1:30", "true"})
    EXPECT_FALSE(parse_number(text)) << text;
}

TEST(ParseInteger, TakesWholeNumbersInAnyForm) {
  EXPECT_EQ(parse_integer("9223372036854775807"), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(parse_integer("-12"), -12);
  EXPECT_EQ(parse_integer("+7"), 7);
  EXPECT_EQ(parse_integer("4e9"), 4'000'000'000);
  EXPECT_EQ(parse_integer("2.0"), 2);
  for (const char* text : {"2.5", "1e17", "9223372036854775808", "-.inf", "x", "", "+-1", "0x10"})
    EXPECT_FALSE(parse_integer(text)) << text;
}

TEST(PrintNumber, ReadsBackAsTheSameNumber) {
  for (const double x : {0.0, -0.0, 3.0, 0.1, 2.4e-3, 1e-6, 4e9, 1e300, 5e-324, 1.7976931348623157e308, -1.0 / 3}) {
    EXPECT_EQ(parse_number(print_number(x)), x) << print_number(x);
    EXPECT_NE(print_number(x).find('.'), std::string::npos) << "YAML 1.1 readers need the point: " << print_number(x);
  }
  EXPECT_EQ(print_number(1e-6), "1.0e-06");
  EXPECT_EQ(parse_number(print_number(-INFINITY)), -INFINITY);
}

TEST(ParseNumber, DoesNotDependOnTheLocale) {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  // Any locale with a decimal comma; the machine may have none, and then the C locale is tried once more.
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE"})
    if (std::setlocale(LC_NUMERIC, name) != nullptr) break;
  EXPECT_EQ(parse_number("0.25"), 0.25);
  EXPECT_FALSE(parse_number("0,25"));
  EXPECT_EQ(print_number(0.25), "0.25");
  std::setlocale(LC_NUMERIC, before.c_str());
}

}  // namespace
}  // namespace grainvdb::number_test
