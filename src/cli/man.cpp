#include <iostream>

#include "cli/commands.hpp"
#include "cli/subcommands.hpp"
#include "grainvdb/version.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* man_footer = R"(Examples:
  grainvdb man > grainvdb.1
  man -l <(grainvdb man))";

// Text as roff prints it: no requests, no hyphens that break copied options.
std::string roff(const std::string& text) {
  std::string result;
  bool at_start = true;
  for (const char c : text) {
    if (at_start && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
    at_start = c == '\n';
  }
  return result;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}

void write_option(std::ostream& out, const CLI::Option& option) {
  out << ".TP\n" << bold(option.get_positional() ? option.get_name(true) : option.get_name(false, true));
  const std::string type = option.get_type_name();  // with what the checks say of it after a colon
  if (!type.empty() && option.get_items_expected_max() > 0)
    out << " \\fI" << roff(type.substr(0, type.find(':'))) << "\\fR";
  out << '\n' << roff(option.get_description());
  if (!option.get_default_str().empty()) out << " (default: " << roff(option.get_default_str()) << ')';
  out << '\n';
}

// Examples and remarks, line by line as they stand in the help.
void write_footer(std::ostream& out, const CLI::App& command) {
  const std::string text = command.get_footer();
  if (text.empty()) return;
  out << ".nf\n" << roff(text) << "\n.fi\n";
}

void write_commands(std::ostream& out, const CLI::App& app, const std::string& chain) {
  for (const CLI::App* command : subcommands_of(app)) {
    const std::string name = chain + ' ' + command->get_name();
    out << ".SS " << roff(name) << '\n' << roff(command->get_description()) << ".\n";
    for (const CLI::Option* option : command->get_options()) write_option(out, *option);
    out << ".PP\n";
    write_footer(out, *command);
    write_commands(out, *command, name);
  }
}

void write_page(std::ostream& out, const CLI::App& app) {
  out << ".TH GRAINVDB 1 \"\" \"grainvdb " << GRAINVDB_VERSION << "\" \"User commands\"\n"
      << ".SH NAME\ngrainvdb \\- continuum fields from particle snapshots of granular flow\n"
      << ".SH SYNOPSIS\n"
      << bold("grainvdb") << " \\fIcommand\\fR [\\fIoptions\\fR] [\\fIarguments\\fR]\n"
      << ".SH DESCRIPTION\n"
         "Reads dumps of discrete\\-element simulations, splats particles and contacts with the Lucy kernel onto "
         "sparse\n"
         "grids, derives the fields of granular rheology and writes them as HDF5 files that ParaView and h5py open.\n"
      << ".SH OPTIONS\n";
  for (const CLI::Option* option : app.get_options()) write_option(out, *option);
  out << ".SH COMMANDS\n";
  write_commands(out, app, "grainvdb");
  out << ".SH EXAMPLES AND EXIT STATUS\n";
  write_footer(out, app);
}

}  // namespace

void add_man(CLI::App& app) {
  CLI::App* command = app.add_subcommand("man", "Print the manual page");
  command->footer(man_footer);
  command->callback([&app] { write_page(std::cout, app); });
}

}  // namespace grainvdb::cli
