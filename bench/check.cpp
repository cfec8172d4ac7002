#include "check.hpp"

#include <cstdio>
#include <map>

namespace grainvdb::bench {
namespace {
std::map<std::string, bool>& made() {
  static std::map<std::string, bool> checks;
  return checks;
}
}  // namespace

bool check_once(const std::string& name, const std::function<double()>& disagreement) {
  if (const auto it = made().find(name); it != made().end()) return it->second;
  const double worst = disagreement();
  const bool agrees = worst <= 1;
  std::fprintf(stderr, "%s %s: the largest error is %.3g of what is tolerated\n", agrees ? "agrees" : "DISAGREES",
               name.c_str(), worst);
  return made()[name] = agrees;
}

bool all_checks_succeeded() {
  for (const auto& [name, agrees] : made())
    if (!agrees) return false;
  return true;
}

}  // namespace grainvdb::bench
