// A spot run gives back the parameters that made it, and a spot file that runs.
#include "spot/calibration.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

#include "measure/spots.hpp"
#include "spot/published_spots.hpp"
#include "spot/random_packing.hpp"
#include "spot/snapshot.hpp"
#include "spot/spot_file.hpp"
#include "support/dump_text.hpp"
#include "support/memory_source.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::spot::calibration_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Numbers = std::vector<double>;

constexpr double interval = 0.07;  // two steps of a spot, which widen R by 1.5 % (docs/spot_calibration.md)
constexpr std::int64_t steady = 100;

Container silo() {
  return {{{-15, 0, 0}, {15, 8, 16}, {false, true, false}}, Orifice{Orifice::Shape::slot, {0, 0}, 4}};
}

SpotParameters unrelaxed() {
  SpotParameters p = published_spots();
  p.relaxation.every = 0;
  return p;
}

Frame frame_of(const SpotModel& model, const Snapshot& before, const Snapshot& now, std::int64_t step) {
  Frame frame;
  frame.file = "memory";
  frame.step = step;
  frame.time = now.time;
  frame.box = silo().box;
  const std::vector<Vec3> velocity = velocities(before, now, model.particles().unit());
  Particles& p = frame.particles;
  p.id = now.id;
  p.radius.assign(now.id.size(), 0.5);
  p.type.assign(now.id.size(), 1);
  for (std::size_t i = 0; i < now.id.size(); ++i) {
    const Vec3 x = model.particles().position_of(now.site[i]);
    for (std::size_t a = 0; a < 3; ++a) {
      p.position[a].push_back(x[a]);
      p.velocity[a].push_back(velocity[i][a]);
    }
  }
  return frame;
}

/// The packing at rest, then frames of the flow once the first spots have left at the top.
std::vector<Frame> spot_frames(std::size_t count) {
  const Packing packing = random_packing(silo().box, 0.58, 1, 3);
  SpotModel model(silo(), packing, unrelaxed(), 5);
  Snapshot before = take_snapshot(model);
  std::vector<Frame> frames{frame_of(model, before, before, 0)};
  model.advance(6.5);
  before = take_snapshot(model);
  for (std::size_t k = 0; k < count; ++k) {
    model.advance(6.5 + interval * static_cast<double>(k + 1));
    Snapshot now = take_snapshot(model);
    frames.push_back(frame_of(model, before, now, steady + static_cast<std::int64_t>(k)));
    before = std::move(now);
  }
  return frames;
}

Pipeline pipeline(const OptionValues& given) {
  Pipeline p = testing::make_pipeline(1, {0, 0, 0}, 3, {});
  p.window = 12;
  OptionValues& options = p.measure["spot_calibration"];
  for (const OptionInfo& o : spot_calibration_measurement().options) options[o.name] = o.default_value;
  for (const auto& [name, value] : given) options.at(name) = value;
  return p;
}

Pipeline of_silo() {
  return pipeline({{"lo", Numbers{-9, 0, 3}},
                   {"hi", Numbers{9, 8, 13}},
                   {"slot_width", 4.0},
                   {"lowest", 4.0},
                   {"highest", 12.0},
                   {"half_width", 12.0},
                   {"reach", 6.0},
                   {"lags", std::int64_t{5}},
                   {"flow_from", steady}});
}

const Quantity& number(const Table& table, const std::string& name) {
  for (const Quantity& q : table.numbers)
    if (q.name == name) return q;
  throw std::out_of_range(name);
}

TEST(Calibration, GivesBackWhatMadeASpotRun) {
  const std::vector<Frame> frames = spot_frames(100);
  const Table t = testing::run(of_silo(), frames).report.tables.front();
  ASSERT_EQ(t.name, "spot_calibration");
  EXPECT_TRUE(t.remarks.empty());
  const SpotParameters made = unrelaxed();
  const double share_of_parts = 0.2;  // no error is so large that anything would pass
  const auto expect = [&](const char* name, double truth) {
    const Quantity& q = number(t, name);
    EXPECT_NEAR(q.value, truth, 3 * q.error) << name;
    EXPECT_LT(q.error, share_of_parts * truth) << name;
    EXPECT_GT(q.error, 0) << name;
  };
  expect("radius", made.radius);
  expect("b", made.step[0] * made.step[0] / (2 * made.step[2]));
  expect("step_side", made.step[0]);
  expect("influence", made.influence);
  expect("hop_rate", made.hop_rate);
  expect("insertion_rate", made.insertion_rate);
  EXPECT_EQ(number(t, "step_up").value, 0.1);
  // Without the share of spots that come back the influence would be off by more than its error.
  const Quantity &w = number(t, "influence"), &share = number(t, "share");
  EXPECT_GT(std::abs(w.value / share.value - made.influence), 3 * w.error);
}

/// A calibration that was not measured.
Table table_of(double radius) {
  Table t{"spot_calibration", "", ""};
  for (const auto& [name, value] : std::vector<std::pair<const char*, double>>{{"radius", radius},
                                                                               {"b", 2.28},
                                                                               {"step_side", 0.676},
                                                                               {"step_up", 0.1},
                                                                               {"influence", 399.04},
                                                                               {"hop_rate", 28},
                                                                               {"insertion_rate", 375},
                                                                               {"volume", 0.2},
                                                                               {"offset", 5.1}})
    t.numbers.push_back({.name = name, .value = value, .error = 0.01 * value, .description = "as published"});
  return t;
}

Pipeline of_dump() {
  Pipeline p = pipeline({{"lo", Numbers{-6, 0, 4}}, {"hi", Numbers{6, 8, 12}}, {"slot_width", 6.0}});
  p.input.particles = {testing::in_repository("sample_dumps/silo/full_*.dump.gz")};
  p.select.types = {1};
  return p;
}

TEST(CalibratedSpotFile, RunsTheSiloOfTheDumps) {
  Pipeline p = of_dump();
  p.frames = {1, std::nullopt, 1};
  const testing::TemporaryFolder folder;
  const std::string file = folder.path() + "/spot.yaml";
  testing::write_plain(file, calibrated_spot_file(p, table_of(2.6), *open_dumps(p.input)));
  const SpotRun run = load_spot_run(file);
  EXPECT_EQ(run.parameters.radius, 2.6);
  EXPECT_EQ(run.parameters.influence, 399);  // four digits
  EXPECT_EQ(run.parameters.step, (Vec3{0.676, 0.676, 0.1}));
  EXPECT_EQ(run.parameters.insertion_rate, 375);
  EXPECT_EQ(run.parameters.wall_distance, 1);
  EXPECT_EQ(run.container.orifice->width, 6);
  // Walls are where the outermost grains are: within a hundredth of those of the deck, x = ±10, for grains touch them.
  EXPECT_NEAR(run.container.box.lo[0], -10, 0.01);
  EXPECT_NEAR(run.container.box.hi[0], 10, 0.01);
  EXPECT_EQ(run.container.box.lo[2], 0);
  EXPECT_TRUE(run.container.box.periodic[1]);
  EXPECT_EQ(run.container.box.hi[1], 8);
  EXPECT_EQ(run.units, "lj");
  EXPECT_NEAR(run.interval, 0.3, 1e-9);
  EXPECT_NEAR(run.end, 0.9, 1e-9);
  EXPECT_GT(run.packing.id.size(), 2500U);
  EXPECT_THAT(run.resolved, HasSubstr("frame: 1"));
}

// The period along y is 8: spots of 3.2 with a diameter around them do not fit.
TEST(CalibratedSpotFile, RelaxesNoMoreThanHalfAPeriod) {
  const Pipeline p = of_dump();
  const testing::TemporaryFolder folder;
  const std::string file = folder.path() + "/spot.yaml";
  testing::write_plain(file, calibrated_spot_file(p, table_of(3.2), *open_dumps(p.input)));
  EXPECT_EQ(load_spot_run(file).parameters.relaxation.radius, 4);
  testing::write_plain(file, calibrated_spot_file(p, table_of(2.8), *open_dumps(p.input)));
  EXPECT_NEAR(load_spot_run(file).parameters.relaxation.radius, 3.8, 1e-12);
}

TEST(CalibratedSpotFile, TakesWallsAndSlotFromTheOptions) {
  Pipeline p = of_dump();
  p.measure["spot_calibration"].at("side_walls") = Numbers{-10.5, 10};
  p.measure["spot_calibration"].at("slot") = 0.5;
  p.measure["spot_calibration"].at("bottom") = 1.0;
  const std::string text = calibrated_spot_file(p, table_of(2.6), *open_dumps(p.input));
  EXPECT_THAT(text, AllOf(HasSubstr("  lo: [-10.5, 0.0, 1.0]\n"), HasSubstr("  hi: [10.0, 8.0, "),
                          HasSubstr("    centre: [0.5, 0]\n"), HasSubstr("  radius: 2.6  # +- 0.026, as published\n")));
}

// A slot of 6 and R = 2.6 make 4.35 where spots enter all over it, and the kernel, c = 3, another 0.75; from the middle
// 2.1 in all.
TEST(CalibratedSpotFile, LetsSpotsInInTheMiddleWhereProfilesAreNarrow) {
  const Pipeline p = of_dump();
  const auto entry = [&](double offset, double error) {
    Table t = table_of(2.6);
    t.numbers.back().value = offset;
    t.numbers.back().error = error;
    const std::string text = calibrated_spot_file(p, t, *open_dumps(p.input));
    return text.substr(text.find("entry: ") + 7, 6);
  };
  EXPECT_EQ(entry(5.1, 0.5), "spread");
  EXPECT_EQ(entry(2.1, 0.5), "centre");
  EXPECT_EQ(entry(2.1, 1), "spread");  // not known well enough
  EXPECT_EQ(entry(std::nan(""), std::nan("")), "spread");
}

TEST(CalibratedSpotFile, IsRefusedWithoutAParameter) {
  const Pipeline p = of_dump();
  try {
    calibrated_spot_file(p, table_of(std::nan("")), *open_dumps(p.input));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("do not tell every parameter"), HasSubstr("radius (nan)")));
  }
}

std::string calibration_refusal(const Pipeline& p) {
  try {
    check_calibration(p);
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "nothing was refused";
}

TEST(CalibratedSpotFile, RefusesWhatItCannotSay) {
  EXPECT_EQ(calibration_refusal(of_dump()), "nothing was refused");
  Pipeline p = of_dump();
  p.measure.clear();
  EXPECT_THAT(calibration_refusal(p), HasSubstr("'measure.spot_calibration' is missing"));
  p = of_dump();
  p.measure["spot_calibration"].at("slot_width") = 0.0;
  EXPECT_THAT(calibration_refusal(p), HasSubstr("measure.spot_calibration.slot_width"));
  p = of_dump();
  p.reduced.emplace();
  EXPECT_THAT(calibration_refusal(p), HasSubstr("units of its dumps"));
  p = of_dump();
  p.select.ids = {1, 100};
  EXPECT_THAT(calibration_refusal(p), HasSubstr("not by id"));
}

}  // namespace
}  // namespace grainvdb::spot::calibration_test
