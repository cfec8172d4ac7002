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
/// The channel of each component of the row-major tensor.
constexpr std::array<int, 9> channel_of{0, 1, 2, 1, 3, 4, 2, 4, 5};

MomentPtr kinetic_stress_moment(const StageSettings& settings) {
  const MomentPtr numerator = velocity_numerator(settings);
  const MomentPtr denominator = velocity_denominator(settings);
  const auto& reference = option<std::string>(settings, "kinetic_stress", "reference");
  const bool time_mean = reference == "time_mean";

  Moment m;
  m.name = "kinetic stress about " + reference + " velocity";
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

void write_symmetric(const StageInput& in, const Moment& moment, SparseField& out) {
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    for (int c = 0; c < 9; ++c) {
      const double* from = in.moment(leaf, moment, channel_of[static_cast<std::size_t>(c)]);
      float* to = out.leaf(leaf, c);
      in.topology().mask(leaf).for_each([&](int v) { to[v] = static_cast<float>(from[v]); });
    }
  });
}

}  // namespace

void register_kinetic_stress(StageRegistry& registry) {
  Stage s;
  s.name = "kinetic_stress";
  s.components = 9;
  s.dimension = dimension::stress;
  s.additive = true;
  s.description = "kinetic stress, tension positive, row-major ij";
  s.equation = "-sum m u'_i u'_j W, u' = v_a - u(x_a)  (8)";
  s.options = {{.name = "reference",
                .default_value = std::string("time_mean"),
                .help = "the velocity that u' is measured from: time_mean (of the output time's frames; a second sweep "
                        "over them), or instantaneous (of the frame)",
                .choices = {"time_mean", "instantaneous"}}};
  s.needs = [](const StageSettings& settings) { return StageNeeds{{}, {kinetic_stress_moment(settings)}}; };
  s.compute = [](const StageInput& in, SparseField& out) {
    write_symmetric(in, *kinetic_stress_moment(in.settings()), out);
  };
  registry.add(std::move(s));
}

}  // namespace grainvdb
