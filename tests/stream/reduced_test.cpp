// Results in units of d, sqrt(d/g) and rho_p d^3: the numbers of the dump's units, divided, and nothing else.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "grainvdb/measurement.hpp"
#include "grainvdb/run.hpp"
#include "stream/same_fields.hpp"
#include "support/memory_source.hpp"
#include "support/memory_tracers.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::reduced_test {
namespace {

using ::testing::HasSubstr;

constexpr ReducedUnits beads{0.8e-3, 9.81, 2500};

/// By powers of d, g and rho_p.
double size_of(const Dimension& q, const ReducedUnits& u) {
  return std::pow(u.density, q.mass) * std::pow(u.diameter, 3 * q.mass + q.length + 0.5 * q.time) *
         std::pow(u.gravity, -0.5 * q.time);
}

/// The two ways to the size of a unit have less than eight roundings each.
bool agree(double value, double expected) {
  return (std::isnan(value) && std::isnan(expected)) ||
         std::abs(value - expected) <= 16 * std::numeric_limits<double>::epsilon() * std::abs(expected);
}

/// A float is rounded once; a tie may fall to either side. The smallest numbers are whole multiples of denorm_min.
bool agree(float value, double expected) {
  using Limits = std::numeric_limits<float>;
  return (std::isnan(value) && std::isnan(expected)) ||
         std::abs(static_cast<double>(value) - expected) <=
             static_cast<double>(Limits::epsilon()) * std::abs(expected) + static_cast<double>(Limits::denorm_min());
}

template <class T, class U>
std::size_t disagreements(const std::vector<T>& values, const std::vector<U>& in_dump_units, double unit) {
  if (values.size() != in_dump_units.size()) return std::max(values.size(), in_dump_units.size());
  std::size_t n = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!agree(values[i], static_cast<double>(in_dump_units[i]) / unit)) ++n;
  return n;
}

std::vector<Frame> timed(std::vector<Frame> frames) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k].step = 10 * static_cast<std::int64_t>(k);
    frames[k].time = 0.125 * static_cast<double>(k);
  }
  return frames;
}

/// The same flow in units in which lengths are so many, times so many and masses so many. With powers of two every
/// sum, product and root has the same digits.
std::vector<Frame> in_other_units(std::vector<Frame> frames, double length, double time, double mass) {
  const auto scale = [](std::vector<double>& values, double factor) {
    for (double& v : values) v *= factor;
  };
  const auto scale3 = [&](Columns3& columns, double factor) {
    for (std::vector<double>& axis : columns) scale(axis, factor);
  };
  for (Frame& f : frames) {
    if (f.time) *f.time *= time;
    for (Vec3* corner : {&f.box.lo, &f.box.hi})
      for (double& x : *corner) x *= length;
    scale3(f.particles.position, length);
    scale3(f.particles.velocity, length / time);
    scale3(f.particles.angular_velocity, 1 / time);
    scale(f.particles.radius, length);
    scale(f.particles.mass, mass);
    scale3(f.contacts.force, mass * length / (time * time));
    scale3(f.contacts.point, length);
  }
  return frames;
}

// d = 2^-10, d/g = 2^-24, rho_p d^3 = 2^-19: velocities and stresses are larger numbers then, none below the least
// normal float.
constexpr ReducedUnits powers_of_two{0x1p-10, 0x1p14, 0x1p11};
constexpr double length = 0x1p-10, time = 0x1p-12, mass = 0x1p-19;
/// Grains so heavy that no stress at the rim of a kernel is below the least normal float, where numbers lose digits.
constexpr double heavy = 0x1p40;

Pipeline in_powers_of_two(Pipeline p) {
  p.voxel *= length;
  p.cutoff *= length;
  for (double& x : p.origin) x *= length;
  set_option(p, "spot_drift", "gravity", std::vector<double>{0, 0, -9.81 * length / (time * time)});
  p.reduced = powers_of_two;
  return p;
}

class Reduced : public ::testing::Test {
 protected:
  Scene scene_ = walled_scene();
  std::vector<Frame> frames_ = timed(scene_.frames);
  Pipeline every_field_ = scene_.pipeline(all_fields());
};

void expect_divided(const Record& reduced, const Record& plain, const ReducedUnits& units) {
  ASSERT_EQ(reduced.times.size(), plain.times.size());
  for (std::size_t t = 0; t < plain.times.size(); ++t) {
    const Written &a = reduced.times[t], &b = plain.times[t];
    EXPECT_TRUE(agree(a.time.time, b.time.time / size_of(dimension::time, units)));
    EXPECT_EQ(a.time.first_step, b.time.first_step);
    EXPECT_EQ(a.mask, b.mask);
    ASSERT_EQ(a.fields.size(), b.fields.size());
    for (const auto& [name, field] : b.fields) {
      const double unit = size_of(field.meta.dimension, units);
      EXPECT_EQ(disagreements(a.field(name).values, field.values, unit), 0U) << name;
      EXPECT_EQ(a.field(name).meta.unit, ReducedUnits::symbol(field.meta.dimension)) << name;
    }
  }
}

TEST_F(Reduced, EveryFieldIsThatOfTheDumpDivided) {
  for (const std::size_t window : {0U, 2U}) {
    every_field_.window = window;
    const Result plain = run(every_field_, frames_);
    every_field_.reduced = beads;
    const Result reduced = run(every_field_, frames_);
    expect_divided(reduced.record, plain.record, beads);
    every_field_.reduced.reset();

    const OutputLayout &a = reduced.record.layouts.at(0), &b = plain.record.layouts.at(0);
    EXPECT_EQ(a.length_unit, "d");
    EXPECT_EQ(a.time_unit, "sqrt(d/g)");
    EXPECT_TRUE(agree(a.lattice.voxel(), b.lattice.voxel() / 0.8e-3));
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_TRUE(agree(a.lattice.origin()[axis], b.lattice.origin()[axis] / 0.8e-3));
    for (const FieldMeta& meta : a.fields) EXPECT_EQ(meta.unit, ReducedUnits::symbol(meta.dimension)) << meta.name;
  }
}

// The dimensions of all fields are those that their values have.
TEST_F(Reduced, TheSameFlowInOtherUnitsGivesTheSameBytes) {
  every_field_.window = 2;
  const std::vector<Frame> frames = in_other_units(frames_, 1, 1, heavy);
  const Result plain = run(every_field_, frames);
  const Result reduced = run(in_powers_of_two(every_field_), in_other_units(frames, length, time, mass));
  expect_same_fields(reduced.record, plain.record);
  EXPECT_EQ(reduced.record.layouts.at(0).lattice.voxel(), plain.record.layouts.at(0).lattice.voxel());
  EXPECT_EQ(reduced.record.layouts.at(0).lattice.origin(), plain.record.layouts.at(0).lattice.origin());
}

TEST_F(Reduced, UnitScalesChangeNoByte) {
  const Result plain = run(every_field_, frames_);
  every_field_.reduced = ReducedUnits{1, 1, 1};
  const Result reduced = run(every_field_, frames_);
  expect_same_fields(reduced.record, plain.record);
  EXPECT_EQ(reduced.only().field("velocity").meta.unit, "sqrt(g d)");
}

TEST_F(Reduced, ErrorsHaveTheUnitsOfTheirFields) {
  Pipeline p = scene_.pipeline(all_errors());
  p.blocks = 3;
  const Result plain = run(p, frames_);
  p.reduced = beads;
  expect_divided(run(p, frames_).record, plain.record, beads);
}

TEST_F(Reduced, StepsStaySteps) {
  for (Frame& f : frames_) f.time.reset();
  Pipeline p = scene_.pipeline({"phi", "velocity"});
  const Result plain = run(p, frames_);
  p.reduced = beads;
  const Result reduced = run(p, frames_);
  EXPECT_EQ(reduced.record.layouts.at(0).time_unit, "step");
  EXPECT_EQ(reduced.only().time.time, plain.only().time.time);
  EXPECT_EQ(reduced.only().field("velocity").meta.unit, "sqrt(g d)");
}

TEST_F(Reduced, TheProvenanceHasTheScales) {
  Pipeline p = scene_.pipeline({"phi"});
  p.reduced = beads;
  const Result result = run(p, frames_);
  const auto& provenance = result.record.provenance;
  const auto it =
      std::find_if(provenance.begin(), provenance.end(), [](const auto& e) { return e.first == "reduced_units"; });
  ASSERT_NE(it, provenance.end());
  EXPECT_THAT(it->second, HasSubstr("d = 8.0e-04 m\ng = 9.81 m/s^2\nrho_p = 2500.0 kg/m^3\nsqrt(d/g) = 0.00903"));
  EXPECT_THAT(it->second, HasSubstr("\nrho_p d^3 = "));
}

// Sums and output times are saved in the units of the dump: what is loaded must not be divided twice.
TEST_F(Reduced, AnInterruptionChangesNoByte) {
  std::string pattern = (std::filesystem::temp_directory_path() / "grainvdb_reduced_XXXXXX").string();
  const std::string folder = mkdtemp(pattern.data());
  Pipeline p = scene_.pipeline({"phi", "velocity", "stress"});
  p.input.contacts.files = {"memory"};
  p.window = 1;
  p.reduced = beads;
  const Result whole = run(p, frames_);
  struct Interruption {};
  const auto record = std::make_shared<Record>();
  for (const std::size_t until : {std::size_t{2}, std::numeric_limits<std::size_t>::max()}) {
    MemorySource source(frames_);
    *record = {};
    std::vector<std::unique_ptr<FieldSink>> sinks;
    sinks.push_back(std::make_unique<MemorySink>(record));
    const auto interrupt = [&](const Progress& now) {
      if (now.frames_done == until) throw Interruption();
    };
    try {
      const RunReport report = run_pipeline(p, make_plan(p), source, sinks, interrupt, CheckpointOptions{folder, 0});
      EXPECT_EQ(report.resumed_at, 2U);
    } catch (const Interruption&) {
      EXPECT_EQ(until, 2U);
    }
  }
  expect_same_fields(*record, whole.record);
  std::filesystem::remove_all(folder);
}

Pipeline traced(Pipeline p, TraceSpec::Through through) {
  p.trace.emplace();
  p.trace->seeds.points = {{0, 3, 2}, {2, 4, 3}};
  p.trace->through = through;
  p.trace->record = {"phi", "velocity", "shear_rate"};
  p.trace->on_undefined = OnUndefined::carry_on;
  if (through == TraceSpec::Through::frames) {
    p.window = 1;
  } else {
    p.trace->duration = 0.5;
    p.trace->steps = 8;
  }
  return p;
}

TEST_F(Reduced, TracersAreThoseOfTheDumpDivided) {
  for (const auto through : {TraceSpec::Through::mean, TraceSpec::Through::frames}) {
    Pipeline p = traced(scene_.pipeline({}), through);
    const Histories plain = trace(p, frames_);
    p.reduced = beads;
    const Histories reduced = trace(p, frames_);
    const double d = beads.diameter, unit_time = size_of(dimension::time, beads);
    EXPECT_EQ(reduced.layout.length_unit, "d");
    EXPECT_EQ(reduced.layout.time_unit, "sqrt(d/g)");
    EXPECT_EQ(reduced.layout.unit_system, "lj");
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_TRUE(agree(reduced.layout.box.lo[a], plain.layout.box.lo[a] / d));
      EXPECT_TRUE(agree(reduced.layout.box.hi[a], plain.layout.box.hi[a] / d));
    }
    ASSERT_EQ(reduced.samples.size(), plain.samples.size());
    ASSERT_GT(plain.samples.size(), 2U);
    for (std::size_t s = 0; s < plain.samples.size(); ++s) {
      const TracerSample &a = reduced.samples[s], &b = plain.samples[s];
      EXPECT_TRUE(agree(a.time, b.time / unit_time));
      EXPECT_EQ(a.step, b.step);
      EXPECT_EQ(a.image, b.image);
      EXPECT_EQ(a.stop, b.stop);
      EXPECT_EQ(disagreements(a.strain, b.strain, 1), 0U);
      EXPECT_EQ(disagreements(a.stop_time, b.stop_time, unit_time), 0U);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(disagreements(a.position[axis], b.position[axis], d), 0U);
        EXPECT_EQ(disagreements(a.displacement[axis], b.displacement[axis], d), 0U);
      }
      for (std::size_t f = 0; f < b.fields.size(); ++f) {
        const FieldMeta& meta = plain.layout.fields[f];
        EXPECT_EQ(disagreements(a.fields[f], b.fields[f], size_of(meta.dimension, beads)), 0U) << meta.name;
        EXPECT_EQ(reduced.layout.fields[f].unit, ReducedUnits::symbol(meta.dimension));
      }
    }
    p.reduced = ReducedUnits{1, 1, 1};
    EXPECT_TRUE(same_histories(trace(p, frames_), plain));
  }
}

const std::vector<std::string> measured{"profile",      "plane_profile",        "pair_correlation", "stationarity",
                                        "coordination", "velocity_correlation", "diffusion"};

std::vector<Table> tables(Pipeline p, const std::vector<Frame>& frames) {
  p.input.contacts.files = {"memory"};
  for (const std::string& name : measured)
    for (const OptionInfo& option : find_measurement(name)->options)
      p.measure[name][option.name] = option.default_value;
  MemorySource source(frames);
  const std::vector<std::unique_ptr<FieldSink>> no_fields;
  return run_pipeline(p, make_plan(p), source, no_fields).tables;
}

using Agree = std::function<bool(double, double)>;

void expect_divided(const std::vector<Table>& reduced, const std::vector<Table>& plain, const ReducedUnits& units,
                    const Agree& equal) {
  ASSERT_EQ(reduced.size(), plain.size());
  for (std::size_t t = 0; t < plain.size(); ++t) {
    const std::string& table = plain[t].name;
    ASSERT_EQ(reduced[t].columns.size(), plain[t].columns.size()) << table;
    for (std::size_t c = 0; c < plain[t].columns.size(); ++c) {
      const TableColumn &a = reduced[t].columns[c], &b = plain[t].columns[c];
      EXPECT_EQ(a.unit, ReducedUnits::symbol(b.dimension)) << table << ' ' << b.name;
      ASSERT_EQ(a.values.size(), b.values.size()) << table << ' ' << b.name;
      for (std::size_t row = 0; row < b.values.size(); ++row)
        EXPECT_TRUE(equal(a.values[row], b.values[row] / size_of(b.dimension, units)))
            << table << ' ' << b.name << ' ' << a.values[row] << ' ' << b.values[row];
    }
    ASSERT_EQ(reduced[t].numbers.size(), plain[t].numbers.size()) << table;
    for (std::size_t n = 0; n < plain[t].numbers.size(); ++n) {
      const Quantity &a = reduced[t].numbers[n], &b = plain[t].numbers[n];
      const double unit = size_of(b.dimension, units);
      EXPECT_EQ(a.unit, ReducedUnits::symbol(b.dimension)) << table << ' ' << b.name;
      EXPECT_TRUE(equal(a.value, b.value / unit)) << table << ' ' << b.name << ' ' << a.value << ' ' << b.value;
      EXPECT_TRUE(equal(a.error, b.error / unit)) << table << ' ' << b.name << ' ' << a.error << ' ' << b.error;
    }
    EXPECT_EQ(reduced[t].remarks, plain[t].remarks);
  }
}

TEST_F(Reduced, TablesAreThoseOfTheDumpDivided) {
  const Scene scene = periodic_scene();
  Pipeline p = scene.pipeline({});
  const std::vector<Table> plain = tables(p, timed(scene.frames));
  ASSERT_GE(plain.size(), measured.size());
  p.reduced = beads;
  expect_divided(tables(p, timed(scene.frames)), plain, beads, [](double a, double b) { return agree(a, b); });
}

// The dimensions of columns and numbers are those that their values have.
TEST_F(Reduced, TheSameFlowInOtherUnitsGivesTheSameTables) {
  const Scene scene = periodic_scene();
  const Pipeline p = scene.pipeline({});
  const std::vector<Table> plain = tables(p, timed(scene.frames));
  const std::vector<Table> reduced =
      tables(in_powers_of_two(p), in_other_units(timed(scene.frames), length, time, mass));
  expect_divided(reduced, plain, {1, 1, 1}, [](double a, double b) { return agree(a, b); });
}

}  // namespace
}  // namespace grainvdb::testing::reduced_test
