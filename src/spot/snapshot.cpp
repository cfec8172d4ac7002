#include "spot/snapshot.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <stdexcept>

namespace grainvdb::spot {
namespace {

void append(std::string& text, double value, int digits) {
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, digits).ptr;
  text.append(buffer, end);
}

void append(std::string& text, std::int64_t value) {
  char buffer[24];
  text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

}  // namespace

Snapshot take_snapshot(const SpotModel& model) {
  const ParticleStore& store = model.particles();
  std::vector<std::int32_t> order;
  order.reserve(store.size());
  for (std::size_t i = 0; i < store.slots(); ++i)
    if (store.holds(static_cast<std::int32_t>(i))) order.push_back(static_cast<std::int32_t>(i));
  std::sort(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) { return store.id(i) < store.id(j); });
  Snapshot snapshot;
  snapshot.time = model.time();
  for (const std::int32_t i : order) {
    snapshot.id.push_back(store.id(i));
    snapshot.site.push_back(store.site(i));
  }
  return snapshot;
}

std::vector<Vec3> velocities(const Snapshot& before, const Snapshot& now, const Vec3& unit) {
  std::vector<Vec3> result(now.id.size());
  const double dt = now.time - before.time;
  std::size_t k = 0;
  for (std::size_t i = 0; i < now.id.size() && dt > 0; ++i) {
    while (k < before.id.size() && before.id[k] < now.id[i]) ++k;
    if (k == before.id.size() || before.id[k] != now.id[i]) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto moved = static_cast<std::int32_t>(static_cast<std::uint32_t>(now.site[i].at[a]) -
                                                   static_cast<std::uint32_t>(before.site[k].at[a]));
      result[i][a] = moved * unit[a] / dt;
    }
  }
  return result;
}

DumpFrame make_frame(const SpotModel& model, const Snapshot& now, const std::vector<Vec3>& velocity) {
  const ParticleStore& store = model.particles();
  DumpFrame frame{now.time, store.box(), store.diameter(), now.id, {}, velocity};
  frame.position.reserve(now.site.size());
  for (const Site& site : now.site) frame.position.push_back(store.position_of(site));
  return frame;
}

std::string dump_text(const DumpFrame& frame, std::int64_t step, const std::string& units) {
  std::string text = "ITEM: UNITS\n" + units + "\nITEM: TIME\n";
  append(text, frame.time, 17);
  text += "\nITEM: TIMESTEP\n";
  append(text, step);
  text += "\nITEM: NUMBER OF ATOMS\n";
  append(text, static_cast<std::int64_t>(frame.id.size()));
  text += "\nITEM: BOX BOUNDS";
  for (const bool periodic : frame.box.periodic) text += periodic ? " pp" : " ff";
  for (std::size_t a = 0; a < 3; ++a) {
    text += '\n';
    append(text, frame.box.lo[a], 17);
    text += ' ';
    append(text, frame.box.hi[a], 17);
  }
  text += std::string("\nITEM: ATOMS id type x y z vx vy vz radius ") + spot_column + '\n';
  text.reserve(text.size() + 110 * frame.id.size());
  for (std::size_t i = 0; i < frame.id.size(); ++i) {
    append(text, frame.id[i]);
    text += " 1";
    for (const Vec3* v : {&frame.position[i], &frame.velocity[i]})
      for (const double component : *v) {
        text += ' ';
        append(text, component, 9);
      }
    text += ' ';
    append(text, 0.5 * frame.diameter, 9);
    text += " 1\n";
  }
  return text;
}

}  // namespace grainvdb::spot
