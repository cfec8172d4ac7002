#include "read/number.hpp"

#include <gtest/gtest.h>

namespace grainvdb::number_test {
namespace {

double real(std::string_view token) {
  double value = -1;
  EXPECT_TRUE(parse_real(token, value)) << token;
  return value;
}
bool is_real(std::string_view token) {
  double value = 0;
  return parse_real(token, value);
}
std::int64_t whole(std::string_view token) {
  std::int64_t value = -1;
  EXPECT_TRUE(parse_whole(token, value)) << token;
  return value;
}
bool is_whole(std::string_view token) {
  std::int64_t value = 0;
  return parse_whole(token, value);
}

TEST(ParseReal, TakesEveryWayInWhichDumpsPrintNumbers) {
  EXPECT_EQ(real("0"), 0.0);
  EXPECT_EQ(real("-0.5"), -0.5);
  EXPECT_EQ(real("+2.5"), 2.5);
  EXPECT_EQ(real(".5"), 0.5);
  EXPECT_EQ(real("5."), 5.0);
  EXPECT_EQ(real("1e-7"), 1e-7);
  EXPECT_EQ(real("-1.6000000000000000e+01"), -16.0);
  EXPECT_EQ(real("0.1"), 0.1);
  EXPECT_EQ(real("5e-324"), 5e-324);
}

TEST(ParseReal, RefusesWhatIsNotOneFiniteNumber) {
  for (const char* token : {"",    "-",   "+",    "+-1",      "1.5e",  "1.5e+",  "1,5",  "1.5x", "x",     "nan",
                            "NaN", "inf", "-inf", "infinity", "1e400", "-1e400", "0x10", "1 2",  "1.5.2", "--1"})
    EXPECT_FALSE(is_real(token)) << token;
}

TEST(ParseReal, StopsAtTheEndOfItsToken) {
  const std::string_view line = "1.25 7";
  double value = 0;
  EXPECT_EQ(parse_real(line.data(), line.data() + line.size(), value), line.data() + 4);
  EXPECT_EQ(value, 1.25);
}

TEST(ParseWhole, TakesWholeNumbersPrintedAsEither) {
  EXPECT_EQ(whole("561"), 561);
  EXPECT_EQ(whole("561.0"), 561);
  EXPECT_EQ(whole("561."), 561);
  EXPECT_EQ(whole("561.000000"), 561);
  EXPECT_EQ(whole("-3"), -3);
  EXPECT_EQ(whole("+3"), 3);
  EXPECT_EQ(whole("9223372036854775807"), 9223372036854775807LL);
}

TEST(ParseWhole, RefusesFractionsExponentsAndOverflow) {
  for (const char* token :
       {"", "-", "+", "+-1", "1.5", "561.01", "1e3", "1e+06", "1.e3", "x", "nan", ".0", "9223372036854775808"})
    EXPECT_FALSE(is_whole(token)) << token;
}

}  // namespace
}  // namespace grainvdb::number_test
