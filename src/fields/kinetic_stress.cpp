#include <array>
#include <cstddef>
#include <utility>

#include "fields/moments.hpp"
#include "fields/register.hpp"
#include "fields/voxels.hpp"

namespace grainvdb {
namespace {

/// The six different components of a symmetric tensor, in the order of the moment's channels.
constexpr std::array<std::pair<std::size_t, std::size_t>, 6> pairs{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};
using Tensor = std::array<double, 9>;  // row by row
/// The channel of each component of the row-major tensor.
constexpr std::array<int, 9> channel_of{0, 1, 2, 1, 3, 4, 2, 4, 5};

const std::string& reference_of(const StageSettings& settings) {
  return option<std::string>(settings, "kinetic_stress", "reference");
}
bool from_moments(const StageSettings& settings) {
  return reference_of(settings) == "time_mean_moments";
}

/// -Σ m u' u' W with u' formed at each particle.
MomentPtr kinetic_stress_moment(const StageSettings& settings) {
  const MomentPtr numerator = velocity_numerator(settings);
  const MomentPtr denominator = velocity_denominator(settings);
  const bool time_mean = reference_of(settings) == "time_mean";

  Moment m;
  m.name = "kinetic stress about " + reference_of(settings) + " velocity";
  m.channels = 6;
  m.columns = Column::mass | Column::velocity;
  (time_mean ? m.mean_needs : m.frame_needs) = {numerator, denominator};
  m.values = [numerator, denominator, time_mean](const FrameView& view, std::span<double> q) {
    const Particles& p = view.particles();
    const std::vector<Vec3> u =
        time_mean ? view.interpolate_mean(*numerator, *denominator) : view.interpolate_frame(*numerator, *denominator);
    for (std::size_t n = 0; n < p.size(); ++n) {
      Vec3 fluctuation;
      for (std::size_t a = 0; a < 3; ++a) fluctuation[a] = p.velocity[a][n] - u[n][a];
      for (std::size_t k = 0; k < pairs.size(); ++k)
        q[pairs.size() * n + k] = -p.mass[n] * fluctuation[pairs[k].first] * fluctuation[pairs[k].second];
    }
  };
  return std::make_shared<const Moment>(std::move(m));
}

/// The second moments of velocity and place, weighed by mass, from which -Σ m u' u' W follows for any u and L.
MomentPtr mass_second_moments() {
  Moment m;
  m.name = "mass second moments of velocity and place";
  m.kind = Moment::Kind::second_moments;
  m.channels = SecondMoments::channels;
  m.columns = Column::mass | Column::velocity;
  m.values = [](const FrameView& view, std::span<double> q) {
    const Particles& p = view.particles();
    for (std::size_t n = 0; n < p.size(); ++n) {
      q[4 * n] = p.mass[n];
      for (std::size_t a = 0; a < 3; ++a) q[4 * n + 1 + a] = p.mass[n] * p.velocity[a][n];
    }
  };
  return std::make_shared<const Moment>(std::move(m));
}

void write_symmetric(const StageInput& in, const Moment& moment, SparseField& out) {
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    for (int c = 0; c < 9; ++c) {
      const double* from = in.moment(leaf, moment, channel_of[static_cast<std::size_t>(c)]);
      float* to = out.leaf(leaf, c);
      in.topology().mask(leaf).for_each([&](int v) { to[v] = static_cast<float>(from[v]); });
    }
  });
}

using Square = std::array<double, pairs.size()>;

/// Σ w (v - u - L r)(v - u - L r) W from the second moments at a voxel.
Square square_about(const std::array<double, SecondMoments::channels>& sum, const Vec3& u, const Tensor& gradient) {
  using SM = SecondMoments;
  const auto place = [&](std::size_t k) { return sum[SM::place + k]; };
  Vec3 first;  // of v - u
  for (std::size_t i = 0; i < 3; ++i) first[i] = sum[SM::velocity + i] - u[i] * sum[SM::weight];
  Tensor slope{};  // Σ w (v - u - ½ L r)_i (L r)_j W
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) {
        double along = sum[SM::velocity_place + 3 * i + k] - u[i] * place(k);
        for (std::size_t l = 0; l < 3; ++l) along -= 0.5 * gradient[3 * i + l] * sum[SM::place_square + SM::pair(l, k)];
        slope[3 * i + j] += gradient[3 * j + k] * along;
      }
  Square square;
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    const auto [i, j] = pairs[n];
    square[n] = sum[SM::velocity_square + SM::pair(i, j)] - u[i] * sum[SM::velocity + j] - u[j] * first[i] -
                slope[3 * i + j] - slope[3 * j + i];
  }
  return square;
}

/// About u + L r, the linear part of the time-mean velocity around the voxel.
void write_from_moments(const StageInput& in, SparseField& out) {
  const MomentPtr moment = mass_second_moments();
  const MomentPtr numerator = velocity_numerator(in.settings());
  const MomentPtr denominator = velocity_denominator(in.settings());
  const SparseField& gradient = in.field("velocity_gradient");
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    const double* weight = in.moment(leaf, *denominator, 0);
    in.topology().mask(leaf).for_each([&](int v) {
      Square stress{};
      if (weight[v] > 0) {
        std::array<double, SecondMoments::channels> sum;
        for (std::size_t c = 0; c < sum.size(); ++c) sum[c] = in.moment(leaf, *moment, static_cast<int>(c))[v];
        Vec3 u;
        for (int a = 0; a < 3; ++a) u[static_cast<std::size_t>(a)] = in.moment(leaf, *numerator, a)[v] / weight[v];
        Tensor slope;
        for (int c = 0; c < 9; ++c) slope[static_cast<std::size_t>(c)] = static_cast<double>(gradient.leaf(leaf, c)[v]);
        for (stress = square_about(sum, u, slope); double& s : stress) s = -s;
      }
      for (int c = 0; c < 9; ++c)
        out.leaf(leaf, c)[v] =
            static_cast<float>(stress[static_cast<std::size_t>(channel_of[static_cast<std::size_t>(c)])]);
    });
  });
}

}  // namespace

void register_kinetic_stress(StageRegistry& registry) {
  Stage s;
  s.name = "kinetic_stress";
  s.components = 9;
  s.dimension = dimension::stress;
  s.additive = true;
  s.of_forces = true;
  s.by_species = true;
  s.description = "kinetic stress, tension positive, row-major ij";
  s.equation = "-sum m u'_i u'_j W, u' = v_a - u(x_a)  (8)";
  s.options = {
      {.name = "reference",
       .default_value = std::string("time_mean"),
       .help =
           "the velocity that u' is measured from: time_mean (of the output time's frames; a second sweep over "
           "them), time_mean_moments (u + L (x_a - x) with u and velocity_gradient L of the time mean at the voxel; "
           "one sweep with more sums), or instantaneous (of the frame)",
       .choices = {"time_mean", "time_mean_moments", "instantaneous"}}};
  s.species_conflict = [](const StageSettings& settings) -> std::optional<OptionConflict> {
    if (!from_moments(settings)) return std::nullopt;
    return OptionConflict{"reference", "'time_mean_moments' for one species",
                          "'time_mean' or 'instantaneous': about the velocity of all grains"};
  };
  s.needs = [](const StageSettings& settings) {
    if (!from_moments(settings)) return StageNeeds{{}, {kinetic_stress_moment(settings)}};
    return StageNeeds{{"velocity_gradient"},
                      {mass_second_moments(), velocity_numerator(settings), velocity_denominator(settings)}};
  };
  s.compute = [](const StageInput& in, SparseField& out) {
    if (from_moments(in.settings())) {
      write_from_moments(in, out);
    } else {
      write_symmetric(in, *kinetic_stress_moment(in.settings()), out);
    }
  };
  registry.add(std::move(s));
}

}  // namespace grainvdb
