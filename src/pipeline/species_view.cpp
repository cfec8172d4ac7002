#include "pipeline/species_view.hpp"

#include <cstddef>
#include <utility>

#include "pipeline/frame_context.hpp"

namespace grainvdb {
namespace {

template <class T>
std::vector<T> rows_of(const std::vector<T>& column, const std::vector<std::size_t>& rows) {
  std::vector<T> some;
  if (column.empty()) return some;
  some.reserve(rows.size());
  for (const std::size_t n : rows) some.push_back(column[n]);
  return some;
}

Columns3 rows_of(const Columns3& columns, const std::vector<std::size_t>& rows) {
  return {rows_of(columns[0], rows), rows_of(columns[1], rows), rows_of(columns[2], rows)};
}

}  // namespace

Particles particles_of_species(const Particles& all, int species) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.species[i] == species) rows.push_back(i);
  return {rows_of(all.id, rows),       rows_of(all.position, rows),
          rows_of(all.velocity, rows), rows_of(all.angular_velocity, rows),
          rows_of(all.radius, rows),   rows_of(all.mass, rows),
          rows_of(all.type, rows),     rows_of(all.force, rows),
          rows_of(all.species, rows)};
}

HalfBranches branches_of_species(const HalfBranches& all, int species) {
  const auto is_in = [&](std::size_t n) { return n < all.size() && all.species[n] == species; };
  std::vector<std::size_t> rows;
  for (const bool both : {true, false})
    for (std::size_t n = 0; n < all.size(); ++n)
      if (is_in(n) && is_in(n ^ 1U) == both) rows.push_back(n);
  return {rows_of(all.start, rows), rows_of(all.arm, rows), rows_of(all.force, rows), rows_of(all.species, rows)};
}

SpeciesView::SpeciesView(const FrameContext& frame, int species, std::shared_ptr<const HalfBranches> branches)
    : frame_(frame),
      species_(species),
      particles_(particles_of_species(frame.particles(), species)),
      branches_(std::move(branches)) {}

std::vector<Vec3> SpeciesView::interpolate_frame(const Moment& numerator, const Moment& denominator) const {
  return frame_.interpolate_frame(numerator, denominator, particles_.position);
}

std::vector<Vec3> SpeciesView::interpolate_mean(const Moment& numerator, const Moment& denominator) const {
  return frame_.interpolate_mean(numerator, denominator, particles_.position);
}

std::vector<double> SpeciesView::deviation_factors(const Moment& denominator) const {
  const std::vector<int>& number = frame_.particles().species;
  std::vector<std::uint8_t> wanted(number.size());
  for (std::size_t i = 0; i < number.size(); ++i) wanted[i] = number[i] == species_;
  const std::vector<double> all = frame_.deviation_factors(denominator, wanted);
  std::vector<double> own;
  own.reserve(particles_.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    if (wanted[i] != 0) own.push_back(all[i]);
  return own;
}

std::vector<Vec3> SpeciesView::interpolate_frame_profile(const Moment& numerator, const Moment& denominator,
                                                         std::array<bool, 3> homogeneous) const {
  return frame_.interpolate_frame_profile(numerator, denominator, homogeneous, particles_.position);
}

}  // namespace grainvdb
