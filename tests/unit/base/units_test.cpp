#include "grainvdb/units.hpp"

#include <string>

#include <gtest/gtest.h>

namespace grainvdb::units_test {
namespace {

std::string symbol(const char* system, const Dimension& d) {
  return find_unit_system(system)->symbol(d);
}

TEST(Units, SymbolsInSi) {
  EXPECT_EQ(symbol("si", dimension::none), "1");
  EXPECT_EQ(symbol("si", dimension::length), "m");
  EXPECT_EQ(symbol("si", dimension::velocity), "m/s");
  EXPECT_EQ(symbol("si", dimension::velocity_squared), "m^2/s^2");
  EXPECT_EQ(symbol("si", dimension::rate), "1/s");
  EXPECT_EQ(symbol("si", dimension::rate_squared), "1/s^2");
  EXPECT_EQ(symbol("si", dimension::density), "kg/m^3");
  EXPECT_EQ(symbol("si", dimension::stress), "Pa");
}

TEST(Units, SymbolsInOtherSystems) {
  EXPECT_EQ(symbol("cgs", dimension::stress), "g/(cm s^2)");
  EXPECT_EQ(symbol("micro", dimension::velocity), "um/us");
  EXPECT_EQ(symbol("lj", dimension::density), "m*/sigma^3");
}

TEST(Units, SystemsAreFoundByName) {
  for (const UnitSystem& u : unit_systems()) EXPECT_EQ(find_unit_system(u.name), &u);
  EXPECT_EQ(find_unit_system("metal"), nullptr);
  EXPECT_EQ(find_unit_system(""), nullptr);
}

}  // namespace
}  // namespace grainvdb::units_test
