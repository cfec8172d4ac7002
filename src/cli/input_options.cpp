#include "cli/input_options.hpp"

#include <array>
#include <functional>
#include <string>

#include "cli/number_checks.hpp"
#include "pipeline/contact_keys.hpp"

namespace grainvdb::cli {
namespace {

void set_box(InputSpec& input, const std::array<double, 6>& corners) {
  Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.lo[a] = corners[a];
    box.hi[a] = corners[a + 3];
  }
  input.box = box;
}

// Where the second name is forgotten the parser takes the next option for it.
CLI::Validator name_of_compute() {
  return {[](const std::string& text) {
            return text.starts_with('-') ? "two names of computes are needed" : std::string();
          },
          ""};
}

}  // namespace

void add_input_options(CLI::App& command, InputSpec& input) {
  command.add_option("dumps", input.particles, "Particle dumps: files, folders or patterns")
      ->required()
      ->type_name("DUMPS");
  command.add_option("--contacts", input.contacts.files, "Contact dumps: files, folders or patterns")
      ->type_name("DUMPS");
  command
      .add_option("--contact-compute", input.contacts.compute,
                  "Keywords of the LIGGGHTS `compute pair/gran/local` that made them")
      ->type_name("KEYWORDS");
  command
      .add_option_function<std::array<std::string, 2>>(
          "--contact-lammps",
          [&input](const std::array<std::string, 2>& names) {
            input.contacts.columns = lammps_contact_columns(names[0], names[1]);
          },
          "Names of the LAMMPS computes `property/local patom1 patom2` and `pair/local fx fy fz p1 p2 p3` that made "
          "them")
      ->type_name("IDS FORCES")
      ->check(name_of_compute());
  command
      .add_option("--wall-contacts", input.wall_contacts.files,
                  "Dumps of contacts with walls that are no grains: files, folders or patterns")
      ->type_name("DUMPS");
  command
      .add_option("--wall-contact-compute", input.wall_contacts.compute,
                  "Keywords of the LIGGGHTS `compute wall/gran/local` that made them")
      ->type_name("KEYWORDS");
  command.add_option("--dt", input.dt, "Time per step, for dumps without times")
      ->type_name("TIME")
      ->check(positive_number());
  command.add_option("--periodic", input.periodic, "Periodic axes, such as xy, or none, for dumps that do not say")
      ->type_name("AXES");
  command
      .add_option_function<std::array<double, 6>>(
          "--box", [&input](const std::array<double, 6>& corners) { set_box(input, corners); },
          "Lower and upper corner of the box, for dumps that do not say")
      ->type_name("X Y Z X Y Z");
}

}  // namespace grainvdb::cli
