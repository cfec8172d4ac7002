#include "read/text.hpp"

#include <gtest/gtest.h>

namespace grainvdb::text_test {
namespace {

TEST(TakeToken, SplitsAtBlanksTabsAndCarriageReturns) {
  std::string_view line = "  a\tb  c\r";
  EXPECT_EQ(take_token(line), "a");
  EXPECT_EQ(take_token(line), "b");
  EXPECT_EQ(take_token(line), "c");
  EXPECT_EQ(take_token(line), "");
}

TEST(InQuotes, ShowsUnprintableBytesAndCutsLongTexts) {
  EXPECT_EQ(in_quotes("abc"), "'abc'");
  EXPECT_EQ(in_quotes(std::string_view("a\0b\n\xff", 5)), "'a\\x00b\\x0a\\xff'");
  EXPECT_EQ(in_quotes(std::string(100, 'x')), "'" + std::string(40, 'x') + "...'");
}

TEST(Joined, CutsLongLists) {
  EXPECT_EQ(joined({}), "");
  EXPECT_EQ(joined({"id", "x", "y"}), "id x y");
  const std::string text = joined(std::vector<std::string>(500, "name"));
  EXPECT_LT(text.size(), 620U);
  EXPECT_TRUE(text.ends_with("name ..."));
}

TEST(IsName, PrintableAndNotEndless) {
  EXPECT_TRUE(is_name("c_clf[13]"));
  EXPECT_FALSE(is_name("c_\x01"));
  EXPECT_FALSE(is_name("caf\xc3\xa9"));
  EXPECT_FALSE(is_name(std::string(201, 'x')));
}

}  // namespace
}  // namespace grainvdb::text_test
