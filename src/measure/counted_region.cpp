#include "measure/counted_region.hpp"

#include <algorithm>
#include <iterator>
#include <string>

namespace grainvdb {
namespace {

using Numbers = std::vector<double>;

std::optional<Vec3> corner(const OptionValues& options, const std::string& name) {
  const auto& numbers = std::get<Numbers>(options.at(name));
  if (numbers.size() != 3) return std::nullopt;
  return Vec3{numbers[0], numbers[1], numbers[2]};
}

}  // namespace

CountedRegion::CountedRegion(const OptionValues& options) : lo_(corner(options, "lo")), hi_(corner(options, "hi")) {}

bool CountedRegion::holds(const Vec3& x) const {
  for (std::size_t a = 0; a < 3; ++a)
    if ((lo_ && x[a] < (*lo_)[a]) || (hi_ && x[a] >= (*hi_)[a])) return false;
  return true;
}

Box CountedRegion::within(const Box& box, const Columns3& position) const {
  Box result = box;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!box.periodic[a] && !position[a].empty()) {
      const auto [lo, hi] = std::minmax_element(position[a].begin(), position[a].end());
      result.lo[a] = *lo;
      result.hi[a] = *hi;
    }
    if (lo_) result.lo[a] = std::max(result.lo[a], (*lo_)[a]);
    if (hi_) result.hi[a] = std::min(result.hi[a], (*hi_)[a]);
  }
  return result;
}

std::vector<OptionInfo> CountedRegion::options(std::vector<OptionInfo> others) {
  std::vector<OptionInfo> all{
      {.name = "lo",
       .default_value = Numbers{},
       .help = "lower corner of the box whose grains count, three numbers [length]; empty: no bound"},
      {.name = "hi",
       .default_value = Numbers{},
       .help = "upper corner of the box whose grains count, three numbers [length]; empty: no bound"}};
  std::move(others.begin(), others.end(), std::back_inserter(all));
  return all;
}

std::optional<OptionConflict> CountedRegion::conflict(const OptionValues& options) {
  for (const std::string name : {"lo", "hi"}) {
    const std::size_t size = std::get<Numbers>(options.at(name)).size();
    if (size != 0 && size != 3)
      return OptionConflict{name, std::to_string(size) + " numbers", "three numbers x, y, z, or none"};
  }
  const auto lo = corner(options, "lo"), hi = corner(options, "hi");
  for (std::size_t a = 0; lo && hi && a < 3; ++a)
    if (!((*lo)[a] < (*hi)[a]))
      return OptionConflict{"hi", std::to_string((*hi)[a]), "more than lo, " + std::to_string((*lo)[a])};
  return std::nullopt;
}

}  // namespace grainvdb
