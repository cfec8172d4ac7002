#include "cli/draft.hpp"

#include <algorithm>
#include <sstream>

#include "base/listed.hpp"
#include "pipeline/number.hpp"
#include "pipeline/text.hpp"
#include "read/contact_columns.hpp"

namespace grainvdb::cli {
namespace {

struct FieldNote {
  const char* name;
  const char* note;
};
constexpr FieldNote notes[] = {
    {"phi", "packing fraction"},
    {"velocity", "volume-weighted mean velocity"},
    {"mean_diameter", "volume-weighted"},
    {"temperature", "granular temperature, the sum over the three components"},
    {"shear_rate", "second invariant of the rate of strain"},
    {"stress", "contact and kinetic stress, tension positive"},
    {"pressure", "-tr(stress)/3, positive in compression"},
    {"shear_stress", "magnitude of the deviator"},
    {"mu", "shear_stress/pressure"},
    {"inertial_number", "shear_rate d √(ρ/pressure)"},
    {"fluidity", "g = shear_rate/mu"},
    {"gd_over_dv", "g d/δv"},
};

std::string list(const std::vector<std::string>& texts) {
  if (texts.size() == 1) return yaml_text(texts.front());
  return '[' + listed(texts, &yaml_text) + ']';
}

std::string types_text(const std::vector<int>& types) {
  std::string result;
  for (const int type : types) result += (result.empty() ? "[" : ", ") + std::to_string(type);
  return result + ']';
}

std::string corner(const Vec3& x) {
  return '[' + print_number(x[0]) + ", " + print_number(x[1]) + ", " + print_number(x[2]) + ']';
}

// LAMMPS takes ids and forces of two computes, LIGGGHTS all of one.
std::string computes_of_contacts(const std::vector<std::string>& columns) {
  const std::vector<ComputeUse> computes = computes_among(columns);
  if (computes.size() != 2) return "compute: [pos, id, force, contactPoint, delta]";
  return "lammps: {ids: " + computes[0].name + ", forces: " + computes[1].name +
         "}   # of property/local patom1 patom2, and pair/local fx fy fz p1 p2 p3";
}

std::string computes_of_wall_contacts(const std::vector<std::string>& /*columns*/) {
  return "compute: [pos, id, force]";
}

// A section of contacts in the pipeline file, and what it says of them.
struct ContactText {
  const char* section;
  const char* purpose;
  const char* noun;
  const char* advice;
  std::string (*computes)(const std::vector<std::string>& columns);
  const char* columns;
};
constexpr ContactText contact_text = {
    .section = "contacts",
    .purpose = "only stresses and what follows from them need these",
    .noun = "contact",
    .advice =
        "  # Name them, or the computes that made them (LAMMPS), or the keywords of the `compute pair/gran/local`\n"
        "  # (LIGGGHTS), and ask for the fields below that need contacts.\n",
    .computes = &computes_of_contacts,
    .columns = "id1: ..., id2: ..., force: [..., ..., ...], point: [..., ..., ...]",
};
constexpr ContactText wall_contact_text = {
    .section = "wall_contacts",
    .purpose = "with walls that are no grains; stresses take them in",
    .noun = "wall contact",
    .advice = "  # Name them, or the keywords of the `compute wall/gran/local` that made them (LIGGGHTS).\n",
    .computes = &computes_of_wall_contacts,
    .columns = "id: ..., force: [..., ..., ...], point: [..., ..., ...]",
};

void write_contacts(std::ostream& out, const ContactText& text, const std::vector<std::string>& files,
                    const std::string& computes, const ContactDumps& dumps) {
  if (dumps.known) {
    const std::string head = std::string("  ") + text.section + ':';
    out << head << std::string(23 - head.size(), ' ') << "# " << text.purpose << "\n    files: " << list(files) << '\n';
    if (!computes.empty()) out << "    " << computes << '\n';
    return;
  }
  out << "  # The columns of the " << text.noun << " dumps do not say what they hold:\n  #  ";
  for (const std::string& column : dumps.columns) out << ' ' << column;
  out << '\n'
      << text.advice << "  # " << text.section << ":\n  #   files: " << list(files) << "\n  #   "
      << text.computes(dumps.columns) << "\n  #   columns: {" << text.columns << "}\n";
}

std::string compute_text(const std::vector<std::string>& keywords) {
  return keywords.empty() ? std::string() : "compute: " + list(keywords);
}

// The columns that the command line names are those of two computes of LAMMPS.
std::string computes_text(const ContactSpec& contacts) {
  if (contacts.columns.empty()) return compute_text(contacts.compute);
  return computes_of_contacts({contacts.columns.at("id1")[0], contacts.columns.at("normal_force")[0]});
}

void write_input(std::ostream& out, const Draft& draft) {
  const InputSpec& input = draft.input;
  out << "input:\n  particles: " << list(input.particles) << "   # relative to this file\n";
  if (input.units)
    out << "  units: " << *input.units << '\n';
  else if (!draft.units_known)
    out << "  # units: si          # or cgs, lj, micro, nano: the dumps do not name theirs\n";
  if (input.dt)
    out << "  dt: " << print_number(*input.dt) << "           # time per step\n";
  else if (!draft.times_known)
    out << "  # dt: 1.0e-6         # time per step: the dumps have no times\n";
  if (input.density) out << "  density: " << print_number(*input.density) << '\n';
  if (input.periodic) out << "  periodic: " << *input.periodic << '\n';
  if (input.box) out << "  box: {lo: " << corner(input.box->lo) << ", hi: " << corner(input.box->hi) << "}\n";
  if (input.radius) out << "  radius: " << print_number(*input.radius) << '\n';
  if (input.contacts.files.empty())
    out << "  # contacts:          # " << contact_text.purpose << "\n  #   files: contacts*\n";
  else
    write_contacts(out, contact_text, input.contacts.files, computes_text(input.contacts), draft.contacts);
  if (!input.wall_contacts.files.empty())
    write_contacts(out, wall_contact_text, input.wall_contacts.files, compute_text(input.wall_contacts.compute),
                   draft.wall_contacts);
}

void write_selection(std::ostream& out, const Survey& survey) {
  if (!survey.has_types) return;
  out << "\n# Which grains count as material. In the last frame:\n";
  for (const Kind& kind : survey.kinds)
    out << "#   type " << kind.type << ": " << kind.count << ' ' << name_of(kind.motion) << '\n';
  out << "select:\n  types: " << types_text(survey.material()) << '\n';
}

void write_fields(std::ostream& out, const Draft& draft) {
  out << "\n# `grainvdb stages` lists all fields, with equations and options.\noutput:\n  fields:\n";
  for (const auto& [name, note] : notes) {
    const bool wanted = std::find(draft.fields.begin(), draft.fields.end(), name) != draft.fields.end();
    const auto refusal = draft.refused.find(name);
    out << (wanted ? "    - " : "    # - ") << name << std::string(18 - std::string(name).size(), ' ') << "# " << note;
    if (refusal != draft.refused.end()) out << "; " << refusal->second;
    out << '\n';
  }
}

}  // namespace

const std::vector<std::string>& common_fields() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const FieldNote& f : notes) all.emplace_back(f.name);
    return all;
  }();
  return names;
}

std::string pipeline_text(const Draft& draft) {
  const double d = draft.survey.mean_diameter();
  const double cutoff = suggested_cutoff(d, draft.box);
  std::ostringstream out;
  out << "# Continuum fields of grains of mean diameter " << short_number(d)
      << ". Every number is in the unit system of the dumps.\n"
         "#   grainvdb graph "
      << draft.command
      << "               shows what would be computed, and from what\n"
         "#   grainvdb run "
      << draft.command << " --output out    computes it\ngrainvdb: 1\n\n";
  write_input(out, draft);
  write_selection(out, draft.survey);
  out << "\nframes: \"::\"           # all; a Python slice first:end:step\n"
         "\n# Cubic voxels of about half a diameter. Periodic lengths must be a whole number of voxels.\n"
         "lattice:\n  voxel: "
      << print_number(draft.voxel)
      << "\n"
         "\n# Each grain is smeared over a sphere of this radius: "
      << short_number(cutoff / d) << " mean diameters.\nkernel:\n  cutoff: " << print_number(cutoff)
      << "\n"
         "\n# One mean over all frames. A number gives a series of means over so many frames, `none` each frame by "
         "itself.\n"
         "average:\n  window: all\n";
  write_fields(out, draft);
  return out.str();
}

}  // namespace grainvdb::cli
