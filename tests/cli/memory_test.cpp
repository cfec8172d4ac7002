// The memory of a run is what its formula says, however many frames there are.
#include <regex>
#include <sstream>
#include <string>

#include <gmock/gmock.h>

#include "cli/command.hpp"

namespace grainvdb::test::memory_test {
namespace {

constexpr int edge = 20;

// 20³ grains of diameter 1. Kept in memory, each frame would take over 1 MB.
std::string rows_of_grains() {
  std::ostringstream rows;
  for (int n = 0; n < edge * edge * edge; ++n)
    rows << n + 1 << ' ' << n / (edge * edge) << ".5 " << n / edge % edge << ".5 " << n % edge << ".5 0.1 0 " << n % 7
         << " 0.5\n";
  return rows.str();
}

void write_frames(const Folder& folder, int frames) {
  const std::string rows = rows_of_grains();
  for (int step = 0; step < frames; ++step)
    folder.write("frames/dump" + std::to_string(step),
                 "ITEM: TIMESTEP\n" + std::to_string(step) + "\nITEM: NUMBER OF ATOMS\n" +
                     std::to_string(edge * edge * edge) +
                     "\nITEM: BOX BOUNDS ff ff ff\n0 20\n0 20\n0 20\nITEM: ATOMS id x y z vx vy vz radius\n" + rows);
  folder.write("p.yaml",
               "grainvdb: 1\n"
               "input: {particles: frames, units: lj, dt: 1}\n"
               "lattice: {voxel: 1}\n"
               "kernel: {cutoff: 2}\n"
               "output: {fields: [phi, velocity]}\n");
}

struct Peak {
  double measured = 0, formula = 0;  // MB
};

Peak peak_over(const Folder& folder, const std::string& frames, const std::string& window) {
  const CommandResult result = run_command(
      {"run", "p.yaml", "--threads", "1", "--frames", frames, "--set", "average.window=" + window}, folder.path());
  std::smatch found;
  EXPECT_EQ(result.exit_code, 0) << result.err;
  if (!std::regex_search(result.out, found, std::regex("memory: ([0-9.]+) MB at most, ([0-9.]+) MB by the formula")))
    return {};
  return {std::stod(found[1]), std::stod(found[2])};
}

TEST(Memory, DoesNotGrowWithTheNumberOfFrames) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep what is freed";
#endif
  const Folder folder;
  write_frames(folder, 60);
  for (const char* window : {"all", "none"}) {
    const Peak few = peak_over(folder, ":4", window), many = peak_over(folder, ":", window);
    ASSERT_GT(few.measured, 0) << window;
    EXPECT_LT(many.measured, 1.2 * few.measured) << window;
    EXPECT_EQ(many.formula, few.formula) << window;
  }
}

}  // namespace
}  // namespace grainvdb::test::memory_test
