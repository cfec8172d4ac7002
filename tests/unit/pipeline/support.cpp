#include "unit/pipeline/support.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace grainvdb::test {

MomentPtr example_moment(Moment moment) {
  return std::make_shared<const Moment>(std::move(moment));
}

Stage example_stage(const std::string& name, std::vector<std::string> fields, std::vector<MomentPtr> moments) {
  Stage stage;
  stage.name = name;
  stage.description = "the field " + name;
  stage.equation = "equation of " + name;
  stage.needs = [needs = StageNeeds{std::move(fields), std::move(moments)}](const StageSettings&) { return needs; };
  return stage;
}

StageRegistry example_registry() {
  // Every call makes new objects, as real stages do: equal names must be enough.
  const auto volume = [] { return example_moment({.name = "volume", .columns = Column::radius}); };
  const auto flux = [] {
    return example_moment({.name = "volume flux", .channels = 3, .columns = Column::radius | Column::velocity});
  };
  const auto fluctuation = example_moment(
      {.name = "fluctuation", .columns = Column::radius | Column::velocity, .frame_needs = {volume(), flux()}});
  const auto kinetic = example_moment(
      {.name = "kinetic", .channels = 6, .columns = Column::mass | Column::velocity, .mean_needs = {volume(), flux()}});
  const auto contact =
      example_moment({.name = "contact", .kind = Moment::Kind::contacts, .channels = 9, .columns = Column::contacts});

  StageRegistry registry;
  Stage phi = example_stage("phi", {}, {volume()});
  phi.additive = true;
  registry.add(phi);
  Stage velocity = example_stage("velocity", {}, {flux(), volume()});
  velocity.components = 3;
  velocity.dimension = dimension::velocity;
  registry.add(velocity);
  Stage temperature = example_stage("temperature", {}, {fluctuation, volume()});
  temperature.options = {{.name = "mode",
                          .default_value = std::string("two_pass"),
                          .help = "how",
                          .choices = {"two_pass", "two_pass_profile", "one_pass"}}};
  registry.add(temperature);
  // Registered before what it needs.
  Stage stress = example_stage("stress", {"contact_stress", "kinetic_stress"}, {});
  stress.components = 9;
  registry.add(stress);
  Stage contact_stress = example_stage("contact_stress", {}, {contact});
  contact_stress.components = 9;
  contact_stress.dimension = dimension::stress;
  contact_stress.options = {
      {.name = "points", .default_value = std::int64_t{0}, .help = "Gauss points", .minimum = 0, .maximum = 8}};
  registry.add(contact_stress);
  Stage kinetic_stress = example_stage("kinetic_stress", {}, {kinetic});
  kinetic_stress.components = 9;
  registry.add(kinetic_stress);
  Stage mu = example_stage("mu", {"stress"}, {});
  mu.options = {
      {.name = "least_pressure", .default_value = 0.5, .help = "pressure below which mu is undefined", .minimum = 0},
      {.name = "strict", .default_value = true, .help = "whether"},
      {.name = "axes", .default_value = std::vector<std::string>{"x"}, .help = "which", .choices = {"x", "y", "z"}}};
  registry.add(mu);
  return registry;
}

PipelineFile::PipelineFile(const std::string& text) {
  std::string pattern = (std::filesystem::temp_directory_path() / "grainvdb_test_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
  path_ = pattern + "/p.yaml";
  std::ofstream(path_, std::ios::binary) << text;
}

PipelineFile::~PipelineFile() {
  std::filesystem::remove_all(folder());
}

std::string PipelineFile::folder() const {
  return std::filesystem::path(path_).parent_path().string();
}

std::string minimal_text() {
  return "grainvdb: 1\n"
         "input:\n"
         "  particles: dumps/*.dump\n"
         "lattice:\n"
         "  voxel: 0.5\n"
         "kernel:\n"
         "  cutoff: 3\n"
         "output:\n"
         "  fields: [phi, velocity]\n";
}

Pipeline load(const std::string& text, const std::vector<std::string>& overrides) {
  const PipelineFile file(text);
  return load_pipeline(file.path(), overrides, example_registry());
}

std::string refusal(const std::string& text, const std::vector<std::string>& overrides) {
  const PipelineFile file(text);
  try {
    load_pipeline(file.path(), overrides, example_registry());
  } catch (const ConfigError& error) {
    std::string message = error.what();
    for (std::size_t at; (at = message.find(file.path())) != std::string::npos;)
      message.replace(at, file.path().size(), "FILE");
    return message;
  }
  ADD_FAILURE() << "not refused:\n" << text;
  return {};
}

}  // namespace grainvdb::test
