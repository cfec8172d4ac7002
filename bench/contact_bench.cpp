#include "contact_bench.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>

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
/// what is tolerated.
double closed_form_error(const Case& c) {
  constexpr double tolerated = 1e-13;
  double worst = 0;
  for (std::size_t b = 0; b < c.branches.size(); b += 16) {
    const auto from = [&](std::size_t a, int i) { return (i + 0.5) * h - c.branches.start[a][b]; };
    const Vec3 arm{c.branches.arm[0][b], c.branches.arm[1][b], c.branches.arm[2][b]};
    for_each_line_weight(c.branches, b, h, [&](int i, int j, int k, double w) {
      const double other = c.setting.kernel.line_integral({from(0, i), from(1, j), from(2, k)}, arm);
      worst = std::max(worst, std::abs(w - other) / (tolerated * lucy_peak(cutoff)));
    });
  }
  return worst;
}

using Sum = std::function<Grids(const Case&)>;

bool check(const std::string& name, const Case& c, const Sum& sum, double error) {
  return check_once(name + " on " + std::to_string(c.branches.size()) + " half branches", [&] {
    return sum_branches(c.branches, h, c.q, channels)
        .disagreement(sum(c), {.relative = 3 * 0x1p-24, .absolute = error * lucy_peak(cutoff)});
  });
}

Grids exact(const Case& c) {
  return exact_contacts(c.branches, h, c.q, channels);
}

Sum library(const ContactMethod& method) {
  return [method](const Case& c) { return contacts_to_grids(c.setting, c.branches, c.q, channels, method); };
}

double known_error(const ContactMethod& method) {
  static std::map<std::string, double> known;
  const auto [it, fresh] = known.try_emplace(method.name, 0.0);
  if (fresh) it->second = branch_error(method);
  return it->second;
}

constexpr double exact_error = 1e-13;      // of the closed form, with room
constexpr double single_precision = 1e-6;  // what sums of several hundred terms lose, in units of the largest

void register_sum(const Sizes& sizes, const std::string& side, const Sum& sum,
                  const std::function<double()>& error_of) {
  const std::string name = "contacts/h=0.5d/" + side;
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    const Case& c = case_of(sizes.contact_particles);
    const double error = error_of();
    if (!check(name, c, sum, error + single_precision)) return state.SkipWithError("the results disagree");
    for (auto _ : state) {
      Grids grids = sum(c);
      benchmark::DoNotOptimize(grids);
    }
    state.counters["half_branches"] = static_cast<double>(c.branches.size());
    state.counters["error_in_W0"] = error;
    state.counters["half_branches/s"] =
        benchmark::Counter(static_cast<double>(c.branches.size()), benchmark::Counter::kIsIterationInvariantRate);
  })->Unit(benchmark::kMillisecond);
}

}  // namespace

void register_contacts(const Sizes& sizes) {
  register_sum(sizes, "exact_scatter", exact, [] { return exact_error; });
  for (const ContactMethod& method : contact_methods())
    register_sum(sizes, "grainvdb_" + method.name, library(method), [method] { return known_error(method); });
}

void check_contacts(const Sizes& sizes) {
  const Case& c = case_of(sizes.contact_particles);
  check_once("contacts/closed form", [&] { return closed_form_error(c); });
  check("contacts/exact_scatter", c, exact, exact_error);
  for (const ContactMethod& method : contact_methods())
    check("contacts/grainvdb_" + method.name, c, library(method), known_error(method) + single_precision);
}

}  // namespace grainvdb::bench
