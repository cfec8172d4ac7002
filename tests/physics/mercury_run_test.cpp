// Files that MercuryDPM wrote itself: what it says of forces, and what its MercuryCG makes of the same files.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::mercury_run_test {
namespace {

constexpr double density = 2.5;
constexpr Vec3 gravity{0.3, 0.2, -1};

std::string sample(const std::string& ending) {
  return in_repository("sample_dumps/formats/settled." + ending);
}

InputSpec input() {
  InputSpec input;
  input.particles = {sample("data")};
  input.contacts.files = {sample("fstat")};
  input.wall_contacts.files = {sample("fstat")};
  input.periodic = "none";
  input.density = density;
  input.units = "si";
  return input;
}

// What 10 digits of the file leave where forces cancel is 7e-9 of the weight of a grain.
TEST(MercuryRun, GrainsAtRestBearTheirWeight) {
  const Frame frame =
      open_dumps(input())->read(1, Column::mass | Column::radius | Column::contacts | Column::wall_contacts);
  ASSERT_EQ(frame.particles.size(), 20U);
  EXPECT_EQ(frame.contacts.size(), 29U);
  EXPECT_EQ(frame.wall_contacts.size(), 22U);
  double heaviest = 0;
  std::vector<Vec3> total;
  for (const double mass : frame.particles.mass) {
    total.push_back({mass * gravity[0], mass * gravity[1], mass * gravity[2]});
    heaviest = std::max(heaviest, mass);
  }
  // Ids are rows, counted from 1.
  const auto add = [&](std::int64_t id, const Columns3& force, std::size_t k, double sign) {
    for (std::size_t a = 0; a < 3; ++a) total[static_cast<std::size_t>(id - 1)][a] += sign * force[a][k];
  };
  const Contacts& pairs = frame.contacts;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    add(pairs.id1[k], pairs.force, k, 1);
    add(pairs.id2[k], pairs.force, k, -1);
  }
  for (std::size_t k = 0; k < frame.wall_contacts.size(); ++k)
    add(frame.wall_contacts.id[k], frame.wall_contacts.force, k, 1);
  for (const Vec3& force : total)
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(force[a], 0, 3e-8 * heaviest);
}

// settled.stat is what `MercuryCG settled -coordinates XYZ -function Lucy -w 2.7 -timeaverage -x 0 2.4 -nx 4 -y 0 2.4
// -ny 4 -z 0 3.6 -nz 6` wrote: six digits, and here 1e-5 of the terms.
class MercuryCG : public ::testing::Test {
 protected:
  MercuryCG() {
    std::ifstream file(sample("stat"));
    std::string line;
    std::getline(file, line);
    std::getline(file, line);
    while (std::getline(file, line)) {
      std::istringstream words(line);
      std::vector<double>& row = rows_.emplace_back();
      for (double value = 0; words >> value;) row.push_back(value);
    }
  }

  static Pipeline pipeline(std::vector<std::string> fields) {
    Pipeline p = make_pipeline(voxel_, {0, 0, 0}, 2.7, std::move(fields));
    p.input = input();
    return p;
  }

  static Coord coord(const std::vector<double>& row) {
    const auto index = [&](std::size_t axis) { return static_cast<int>(std::lround(row[1 + axis] / voxel_ - 0.5)); };
    return {index(0), index(1), index(2)};
  }

  // The field has so many components, the first of which stands in that column, counted from 0.
  void expect_same(const FieldCopy& field, std::size_t column, int components, double sign) const {
    double largest = 0;
    for (const auto& row : rows_)
      for (int k = 0; k < components; ++k)
        largest = std::max(largest, std::abs(row.at(column + static_cast<std::size_t>(k))));
    EXPECT_GT(largest, 0);
    for (const auto& row : rows_)
      for (int k = 0; k < components; ++k)
        EXPECT_NEAR(static_cast<double>(field.at(coord(row), k)), sign * row[column + static_cast<std::size_t>(k)],
                    2e-5 * largest)
            << "column " << column + static_cast<std::size_t>(k);
  }

  static constexpr double voxel_ = 0.6;
  std::vector<std::vector<double>> rows_;
};

TEST_F(MercuryCG, HasTheSameSums) {
  ASSERT_EQ(rows_.size(), 96U);
  const Pipeline p = pipeline({"phi", "density", "contact_stress", "wall_force"});
  const Result r = run(p, *open_dumps(p.input));
  expect_same(r.only().field("phi"), 4, 1, 1);
  expect_same(r.only().field("density"), 5, 1, 1);
  expect_same(r.only().field("contact_stress"), 15, 9, -1);
  expect_same(r.only().field("wall_force"), 24, 3, 1);
}

TEST_F(MercuryCG, HasTheSameMomentum) {
  Pipeline p = pipeline({"density", "velocity"});
  set_option(p, "velocity", "weighting", std::string("mass"));
  const Result r = run(p, *open_dumps(p.input));
  double largest = 0;
  for (const auto& row : rows_) largest = std::max(largest, std::hypot(row.at(6), row.at(7), row.at(8)));
  for (const auto& row : rows_)
    for (int a = 0; a < 3; ++a) {
      const double momentum = static_cast<double>(r.only().field("density").at(coord(row), 0)) *
                              static_cast<double>(r.only().field("velocity").at(coord(row), a));
      EXPECT_NEAR(momentum, row[6 + static_cast<std::size_t>(a)], 2e-5 * largest);
    }
}

}  // namespace
}  // namespace grainvdb::testing::mercury_run_test
