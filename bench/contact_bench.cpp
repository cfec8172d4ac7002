#include "contact_bench.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "check.hpp"
#include "dense_sums.hpp"
#include "exact_contacts.hpp"
#include "library_paths.hpp"
#include "lucy.hpp"

namespace grainvdb::bench {
namespace {

constexpr double h = 0.5;
constexpr int channels = 9;

struct Case {
  explicit Case(std::size_t particles)
      : branches(make_branches(make_scene(particles))), q(stress_values(branches)), setting(h) {}
  HalfBranches branches;
  std::vector<double> q;
  Setting setting;
};

const Case& case_of(std::size_t particles) {
  static std::unique_ptr<Case> made;
  static std::size_t made_for = 0;
  if (!made || made_for != particles) made = std::make_unique<Case>(particles);
  made_for = particles;
  return *made;
}

/// The largest error of one branch in units of W(0): contacts so far apart that no voxel sees two of them.
double branch_error(const ContactMethod& method) {
  const HalfBranches all = make_branches(make_scene(500));
  constexpr std::size_t edge = 6;  // of the array of contacts
  constexpr double spacing = 3 * cutoff;
  HalfBranches apart;
  for (std::size_t n = 0; n < 2 * edge * edge * edge && n < all.size(); ++n) {
    const std::size_t contact = n / 2;
    const std::array<std::size_t, 3> place{contact / (edge * edge), contact / edge % edge, contact % edge};
    for (std::size_t a = 0; a < 3; ++a) {
      // Both halves keep their place relative to their contact point, each contact its place relative to the voxels.
      const double point = all.start[a][2 * contact] - all.arm[a][2 * contact];
      const double corner = spacing * static_cast<double>(place[a]) + point - h * std::floor(point / h);
      apart.start[a].push_back(corner + all.start[a][n] - point);
      apart.arm[a].push_back(all.arm[a][n]);
      apart.force[a].push_back(0);
    }
  }
  const std::vector<double> ones(apart.size(), 1.0);
  return sum_branches(apart, h, ones, 1)
      .disagreement(contacts_to_grids(Setting(h), apart, ones, 1, method), {.absolute = lucy_peak(cutoff)});
}

/// The baseline's closed form against the library's, which shares no code with it: the largest difference in units of
/// W(0).
double closed_form_error() {
  const Case c(256);
  double worst = 0;
  for (std::size_t b = 0; b < c.branches.size(); b += 16) {
    const auto from = [&](std::size_t a, int i) { return (i + 0.5) * h - c.branches.start[a][b]; };
    const Vec3 arm{c.branches.arm[0][b], c.branches.arm[1][b], c.branches.arm[2][b]};
    for_each_line_weight(c.branches, b, h, [&](int i, int j, int k, double w) {
      const double other = c.setting.kernel.line_integral({from(0, i), from(1, j), from(2, k)}, arm);
      worst = std::max(worst, std::abs(w - other) / lucy_peak(cutoff));
    });
  }
  return worst;
}

/// One way to have the sums.
struct Side {
  std::string name;
  std::function<Grids(const Case&)> sums;
  double promised = 0;               ///< largest error of a branch in units of W(0)
  std::function<double()> measured;  ///< the same as found
};

std::vector<Side> all_sides() {
  std::vector<Side> sides{{.name = "exact_scatter",
                           .sums = [](const Case& c) { return exact_contacts(c.branches, h, c.q, channels); },
                           .promised = 1e-13,
                           .measured = closed_form_error}};
  for (const ContactMethod& method : contact_methods())
    sides.push_back(
        {.name = "grainvdb_" + method.name,
         .sums = [method](const Case& c) { return contacts_to_grids(c.setting, c.branches, c.q, channels, method); },
         .promised = method.error,
         .measured = [method] { return branch_error(method); }});
  return sides;
}

std::string full_name(const Side& side) {
  return "contacts/h=0.5d/" + side.name;
}

bool check(const Side& side, const Case& c) {
  const std::string name = full_name(side);
  const bool alone = check_once(name + ", one branch", [&] { return side.measured() / side.promised; });
  return check_once(name + " on " + std::to_string(c.branches.size()) + " half branches",
                    [&] {
                      return sum_branches(c.branches, h, c.q, channels)
                          .disagreement(side.sums(c),
                                        {.relative = 3 * 0x1p-24, .absolute = side.promised * lucy_peak(cutoff)});
                    }) &&
         alone;
}

void register_side(const Sizes& sizes, const Side& side) {
  benchmark::RegisterBenchmark(full_name(side).c_str(), [=](benchmark::State& state) {
    const Case& c = case_of(sizes.contact_particles);
    if (!check(side, c)) return state.SkipWithError("the results disagree");
    const double error = side.measured();
    for (auto _ : state) {
      Grids grids = side.sums(c);
      benchmark::DoNotOptimize(grids);
    }
    const auto branches = static_cast<double>(c.branches.size());
    state.counters["half_branches"] = branches;
    state.counters["error_in_W0"] = error;
    state.counters["half_branches/s"] = benchmark::Counter(branches, benchmark::Counter::kIsIterationInvariantRate);
  })->Unit(benchmark::kMillisecond);
}

}  // namespace

void register_contacts(const Sizes& sizes) {
  for (const Side& side : all_sides()) register_side(sizes, side);
}

void check_contacts(const Sizes& sizes) {
  const Case& c = case_of(sizes.contact_particles);
  for (const Side& side : all_sides()) check(side, c);
}

}  // namespace grainvdb::bench
