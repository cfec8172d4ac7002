// What the calibration of the spot model is made of: flow through planes, looseness, parameters from observations.
#include "measure/spots.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/spot_diffusion.hpp"
#include "lattices.hpp"
#include "measure/loosening.hpp"
#include "measure/plane_counts.hpp"
#include "measure/spot_parameters.hpp"
#include "measure/time_groups.hpp"

namespace grainvdb::testing::spots_test {
namespace {

using Numbers = std::vector<double>;

const Box column_box{{0, 0, 0}, {6, 6, 40}, {true, true, false}};

/// A column of grains at random places that falls by `speed`, in frames 0.5 apart, the first at rest.
std::vector<Frame> falling(std::size_t count, double speed) {
  const Scene scene = poisson({{0, 0, 20}, {6, 6, 40}, column_box.periodic}, 4000, 11);
  std::vector<Frame> frames;
  for (std::size_t n = 0; n < count; ++n) {
    Frame f = scene.frame();
    f.box = column_box;
    f.step = static_cast<std::int64_t>(10 * n);
    f.time = 0.5 * static_cast<double>(n);
    for (double& z : f.particles.position[2]) z -= speed * *f.time;
    for (auto& column : f.particles.velocity) column.assign(scene.size(), 0);
    f.particles.velocity[2].assign(scene.size(), -speed);
    frames.push_back(std::move(f));
  }
  return frames;
}

std::vector<Table> tables_of(const MeasurementInfo& info, const std::vector<Frame>& frames, const OptionValues& given) {
  OptionValues options;
  for (const OptionInfo& o : info.options) options[o.name] = o.default_value;
  for (const auto& [name, value] : given) options.at(name) = value;
  if (info.conflict && info.conflict(options)) throw std::invalid_argument(info.conflict(options)->option);
  const Lattice lattice(1, {0, 0, 0});
  const StageSettings stages;
  const auto m = info.make({options, stages, lattice, LucyKernel(3), column_box, std::nullopt});
  for (const Frame& frame : frames) m->add(frame);
  return m->tables();
}

const Quantity& quantity(const Table& table, const std::string& name) {
  for (const Quantity& q : table.numbers)
    if (q.name == name) return q;
  throw std::out_of_range(name);
}

// 4000 grains in 720: 5.56 in a unit of volume, 200 through each unit of height. Those that pass a plane are Poisson.
TEST(Outflow, CountsGrainsThroughPlanes) {
  const auto tables = tables_of(outflow_measurement(), falling(21, 0.8), {{"heights", Numbers{25, 28, 31}}});
  ASSERT_EQ(tables.size(), 2U);
  const double expected = 200 * 0.8;
  for (std::size_t plane = 0; plane < 3; ++plane)
    EXPECT_NEAR(tables[0].columns[1].values[plane], expected, 5 * std::sqrt(expected * 10) / 10);
  const Quantity& rate = quantity(tables[0], "rate");
  EXPECT_NEAR(rate.value, expected, 4 * rate.error);
  EXPECT_LT(rate.error, 0.1 * expected);
  EXPECT_EQ(tables[1].columns[0].values.size(), 21U);
  EXPECT_GT(tables[1].columns[1].values[0], tables[1].columns[2].values[0]);
}

TEST(Outflow, IsNotKnownWithoutTimes) {
  std::vector<Frame> frames = falling(4, 0.8);
  for (Frame& f : frames) f.time.reset();
  const auto tables = tables_of(outflow_measurement(), frames, {});
  EXPECT_TRUE(std::isnan(quantity(tables[0], "rate").value));
  EXPECT_FALSE(tables[0].remarks.empty());
  EXPECT_THROW(tables_of(outflow_measurement(), frames, {{"heights", Numbers{}}}), std::invalid_argument);
}

// The weight is odd about each face, so that it comes to the volume of the box however wide its slopes are.
TEST(SmoothBox, IntegratesToItsVolume) {
  const SmoothBox box{{-1, 2, 5}, {9, 4, 15}};
  const SmoothBox cut = box.within(column_box);
  EXPECT_EQ(cut.lo[0], 0);
  EXPECT_EQ(cut.hi[0], 6);
  double sum = 0;
  constexpr int n = 40;  // cells along each axis; the weight is a cubic, midpoints are good to 1e-3 of a slope
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        sum += cut.weight(column_box, {6 * (i + 0.5) / n, 6 * (j + 0.5) / n, 40 * (k + 0.5) / n}, 1) * 6 * 6 * 40 /
               (n * n * n);
  EXPECT_NEAR(sum, cut.volume(), 1e-3 * cut.volume());
  EXPECT_EQ(cut.weight(column_box, {0.1, 3, 10}, 1), 1);
  EXPECT_EQ(cut.weight(column_box, {0.1, 3, 5}, 1), 0.5);
  EXPECT_EQ(cut.weight(column_box, {0.1, 3, 3.9}, 1), 0);
}

/// The same column, with a share of its grains taken out in all frames but the first.
std::vector<Frame> loosened(std::size_t count, double speed, std::size_t every) {
  std::vector<Frame> frames = falling(count, speed);
  for (std::size_t n = 1; n < count; ++n) {
    Frame thinner = frames[n];
    Particles& p = thinner.particles;
    p = {};
    for (std::size_t i = 0; i < frames[n].particles.size(); ++i) {
      if (i % every == 0) continue;
      p.id.push_back(frames[n].particles.id[i]);
      p.radius.push_back(0.5);
      for (std::size_t a = 0; a < 3; ++a) {
        p.position[a].push_back(frames[n].particles.position[a][i]);
        p.velocity[a].push_back(frames[n].particles.velocity[a][i]);
      }
    }
    frames[n] = std::move(thinner);
  }
  return frames;
}

// A tenth is missing: c = 0.9 v/0.1. The box looks at the middle of the column, whose grains are at random places.
TEST(DensityDrop, TellsTheSpeedOfWhatIsMissing) {
  const OptionValues box{{"lo", Numbers{0, 0, 23}}, {"hi", Numbers{6, 6, 36}}};
  const auto frames = loosened(17, 0.2, 10);
  const Table t = tables_of(density_drop_measurement(), frames, box).front();
  const double sphere = std::numbers::pi / 6, n = 4000.0 / 720;
  EXPECT_EQ(t.columns[1].values.size(), 16U);
  for (const auto& [name, expected] : std::vector<std::pair<const char*, double>>{{"phi_at_rest", n * sphere},
                                                                                  {"phi", 0.9 * n * sphere},
                                                                                  {"drop", 0.1 * n * sphere},
                                                                                  {"flux", 0.18 * n * sphere},
                                                                                  {"speed", 9 * 0.2}}) {
    const Quantity& q = quantity(t, name);
    // What random places scatter by, once: √(1/2600) of the density.
    EXPECT_NEAR(q.value, expected,
                (name == std::string("drop") || name == std::string("speed") ? 0.4 : 0.06) * expected)
        << name;
    EXPECT_GT(q.error, 0) << name;
  }
  // Told that the packing at rest is so dense, it takes the first frame for flow.
  OptionValues known = box;
  known["phi_at_rest"] = 0.99;
  const Table u = tables_of(density_drop_measurement(), frames, known).front();
  EXPECT_EQ(u.columns[1].values.size(), 17U);
  EXPECT_EQ(quantity(u, "phi_at_rest").value, 0.99);
  // Frames before the flow do not count.
  OptionValues late = box;
  late["flow_from"] = std::int64_t{100};
  EXPECT_EQ(tables_of(density_drop_measurement(), frames, late).front().columns[1].values.size(), 7U);
  EXPECT_THROW(tables_of(density_drop_measurement(), frames, {}), std::invalid_argument);
}

// Layers at heights with n = n_0 - j/c exactly: grains one above another, spaced as n says and as fast as j says.
TEST(DensityDrop, TellsTheSpeedOfLayers) {
  constexpr double at_rest = 10, c = 3;  // grains in a unit of height, of an area of 36
  Frame f;
  f.file = "layers";
  f.box = column_box;
  for (double z = 0.01; z < 40;) {
    const double flux = 3 * (1 - z / 60), n = at_rest - flux / c;
    f.particles.id.push_back(static_cast<std::int64_t>(f.particles.id.size()) + 1);
    f.particles.radius.push_back(0.5);
    for (std::size_t a = 0; a < 3; ++a) f.particles.velocity[a].push_back(a == 2 ? -flux / n : 0);
    const double x[] = {3, 3, z};
    for (std::size_t a = 0; a < 3; ++a) f.particles.position[a].push_back(x[a]);
    z += 1 / n;
  }
  const OptionValues options{{"lo", Numbers{0, 0, 5}}, {"hi", Numbers{6, 6, 35}}, {"reference", std::string("layers")}};
  const Table t = tables_of(density_drop_measurement(), {f, f, f, f}, options).front();
  // Sums over some twenty grains a layer, whose weights are smooth.
  EXPECT_NEAR(quantity(t, "speed").value, c, 0.02 * c);
  EXPECT_NEAR(quantity(t, "phi_at_rest").value, at_rest / 36 * std::numbers::pi / 6, 2e-3);
}

SpotObservations published() {
  const DiffusionShare share({2.6, {0.676, 0.676, 0.1}});
  SpotObservations o;
  o.radius = {2.6, 0.05};
  o.b = {0.676 * 0.676 / 0.2, 0.1};
  o.speed = {2.8, 0.1};
  o.number_density = {79.8 / (4 * std::numbers::pi / 3 * 2.6 * 2.6 * 2.6), 0.01};
  o.outflow = {75, 1};
  o.times = {0.5};
  o.grain_diffusion = {share.after(14) * o.b.value / 399, 1e-4};
  o.rise = 0.1;
  return o;
}

TEST(SpotParameters, AreThoseOfThePublishedSilo) {
  const SpotObservations o = published();
  const SpotParameterEstimates p = spot_parameters(o);
  EXPECT_NEAR(p.step.value, 0.676, 1e-12);
  EXPECT_NEAR(p.influence.value, 399, 1e-9);
  EXPECT_NEAR(p.grains.value, 79.8, 1e-9);
  EXPECT_NEAR(p.volume.value, 0.2, 1e-12);
  EXPECT_NEAR(p.hop_rate.value, 28, 1e-12);
  EXPECT_NEAR(p.insertion_rate.value, 375, 1e-9);
  // Errors of products are those of the factors: N by R³ and n, Δx by √b, the hop rate by the speed.
  EXPECT_NEAR(p.grains.error / 79.8, std::hypot(3 * 0.05 / 2.6, 0.01 / o.number_density.value), 1e-3);
  EXPECT_NEAR(p.step.error / 0.676, 0.05 / o.b.value, 1e-4);
  EXPECT_NEAR(p.hop_rate.error, 1, 1e-12);
  EXPECT_GT(p.influence.error / 399, std::hypot(0.1 / o.b.value, 1e-4 / o.grain_diffusion.value) * 0.8);
  EXPECT_GT(p.insertion_rate.error / 375, p.influence.error / 399);
}

TEST(SpotParameters, AreNotKnownWithoutWhatTheyComeFrom) {
  SpotObservations o = published();
  o.speed = {-3, 1};
  const SpotParameterEstimates p = spot_parameters(o);
  EXPECT_TRUE(std::isnan(p.hop_rate.value));
  EXPECT_TRUE(std::isnan(p.influence.value));
  EXPECT_NEAR(p.grains.value, 79.8, 1e-9);
  EXPECT_TRUE(std::isfinite(p.grains.error));
}

TEST(TimeGroups, TellTheErrorOfAMeanOfDependentSamples) {
  // Each of ten values comes four times: forty samples are worth ten.
  Random random(3);
  double stated = 0, scatter = 0;
  constexpr int runs = 200;
  for (int run = 0; run < runs; ++run) {
    std::vector<double> values;
    for (int k = 0; k < 10; ++k) values.insert(values.end(), 4, random.normal());
    const Estimate mean = mean_by_time_groups(values);
    stated += mean.error * mean.error / runs;
    scatter += mean.value * mean.value / runs;
  }
  EXPECT_NEAR(stated, 0.1, 0.02);  // 200 times nine degrees of freedom: 3 %
  EXPECT_NEAR(scatter, 0.1, 0.04);
  EXPECT_TRUE(std::isnan(mean_by_time_groups({1, 2, 3}).error));
}

TEST(SpotMeasurements, SaySoWhereThereAreNoGrains) {
  Frame empty;
  empty.box = column_box;
  const OptionValues box{{"lo", Numbers{0, 0, 23}}, {"hi", Numbers{6, 6, 36}}};
  for (const MeasurementInfo& info :
       {outflow_measurement(), density_drop_measurement(), spot_calibration_measurement()})
    for (const std::vector<Frame>& frames : {std::vector<Frame>{}, std::vector<Frame>{empty, empty}})
      for (const Table& table : tables_of(info, frames, info.name == "outflow" ? OptionValues{} : box))
        EXPECT_FALSE(table.remarks.empty()) << table.name;
}

TEST(SpotCalibration, RefusesOptionsThatMeanNothing) {
  const MeasurementInfo info = spot_calibration_measurement();
  OptionValues options;
  for (const OptionInfo& o : info.options) options[o.name] = o.default_value;
  EXPECT_EQ(info.conflict(options)->option, "lo");
  options["lo"] = Numbers{-5, 0, 5};
  options["hi"] = Numbers{5, 8, 15};
  EXPECT_FALSE(info.conflict(options));
  options["side_walls"] = Numbers{3, -3};
  EXPECT_EQ(info.conflict(options)->option, "side_walls");
  options["side_walls"] = Numbers{};
  options["components"] = std::vector<std::string>{};
  EXPECT_EQ(info.conflict(options)->option, "components");
}

}  // namespace
}  // namespace grainvdb::testing::spots_test
