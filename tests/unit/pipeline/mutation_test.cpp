/// Damaged pipeline files: whatever the damage, loading ends with a pipeline or with one ConfigError.
#include <random>

#include "grainvdb/plan.hpp"
#include "unit/pipeline/support.hpp"

namespace grainvdb::mutation_test {
namespace {

const std::string seed_text =
    "grainvdb: 1\n"
    "input: {particles: [a, \"b*\"], dt: 1.0e-6, units: si, contacts: {files: c, compute: [id, force]}}\n"
    "select: &s {types: [1, 2], region: {lo: [-.inf, 0, 0], hi: [1, 1, .inf]}}\n"
    "frames: '::2'\n"
    "lattice:\n  voxel: 0.5\n  origin: [0, 0, 0]\n"
    "kernel: {name: lucy, cutoff: 3}\n"
    "average: {window: all}\n"
    "walls: {kernel: mask, box: [x_lo], surfaces: [{plane: {point: [0, 0, 0], normal: [0, 0, 1]}}]}\n"
    "output:\n  fields:\n    - phi\n    - temperature\n"
    "stages: {mu: {strict: false, axes: [x, y], least_pressure: 1}}\n"
    "limits: {extent: 1000, dense_voxels: 4e9}\n";

std::string mutated(std::mt19937& random) {
  static const std::vector<std::string> pieces{
      "*s",    "&s ", "<<: ", "[",     "]",      "{",         "}",   ":", ": ",      "\n",   "  ",   "- ",
      "#",     "'",   "\"",   "---\n", "!!int ", "|",         ">",   "~", "null",    "nan",  ".inf", "-1",
      "1e999", "\t",  "\xff", "\x01",  "? ",     "%YAML 9\n", "...", "@", "a: b: c", "0x10", ",",    "velocity"};
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  std::string text = seed_text;
  for (std::size_t edits = 1 + below(2); edits > 0; --edits) {
    const std::size_t at = below(text.size()), length = std::min(below(12), text.size() - at);
    switch (below(4)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, pieces[below(pieces.size())]);
        break;
      case 2:
        text.insert(at, text.substr(below(text.size()), below(40)));
        break;
      default:
        text.replace(at, std::min<std::size_t>(1, length), 1, static_cast<char>(below(256)));
    }
    if (text.empty()) break;
  }
  return text;
}

TEST(Mutations, EndWithAPipelineOrOneError) {
  const StageRegistry registry = test::example_registry();
  std::mt19937 random(20240611);
  int loaded = 0, refused = 0;
  for (int i = 0; i < 1500; ++i) {
    const std::string text = mutated(random);
    SCOPED_TRACE(text);
    const test::PipelineFile file(text);
    try {
      const Pipeline pipeline = load_pipeline(file.path(), {}, registry);
      ASSERT_GT(pipeline.voxel, 0);
      ASSERT_GT(pipeline.cutoff, 0);
      ASSERT_FALSE(pipeline.fields.empty());
      // What is accepted must also be reproducible from its resolved text.
      const test::PipelineFile again(pipeline.resolved);
      ASSERT_EQ(load_pipeline(again.path(), {}, registry).resolved, pipeline.resolved);
      ++loaded;
    } catch (const ConfigError& error) {
      ASSERT_NE(std::string(error.what()).find(file.path()), std::string::npos) << error.what();
      ++refused;
    }
  }
  // Both ways out were taken often.
  EXPECT_GT(loaded, 20);
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace grainvdb::mutation_test
