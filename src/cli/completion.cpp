#include <iostream>

#include "cli/commands.hpp"
#include "cli/subcommands.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* completion_footer = R"(Examples:
  source <(grainvdb completion)
  grainvdb completion > ~/.local/share/bash-completion/completions/grainvdb)";

std::string words_of(const CLI::App& app) {
  std::string words;
  for (const CLI::App* command : subcommands_of(app)) words += command->get_name() + ' ';
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) words += "--" + name + ' ';
  if (!words.empty()) words.pop_back();
  return words;
}

// The words that may follow each chain of commands, as branches of a shell `case`.
void write_words(std::ostream& out, const CLI::App& app, const std::string& chain) {
  out << "    \"" << chain << "\") words=\"" << words_of(app) << "\" ;;\n";
  for (const CLI::App* command : subcommands_of(app)) write_words(out, *command, chain + ' ' + command->get_name());
}

void write_chains(std::ostream& out, const CLI::App& app, const std::string& chain) {
  for (const CLI::App* command : subcommands_of(app)) {
    const std::string longer = chain + ' ' + command->get_name();
    out << "      \"" << longer << "\") chain=\"" << longer << "\" ;;\n";
    write_chains(out, *command, longer);
  }
}

void write_completion(std::ostream& out, const CLI::App& app) {
  out << "# bash completion for grainvdb, as `grainvdb completion` prints it\n"
         "_grainvdb() {\n"
         "  local cur=${COMP_WORDS[COMP_CWORD]} chain=\"\" words=\"\" i\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    case \"$chain ${COMP_WORDS[i]}\" in\n";
  write_chains(out, app, "");
  out << "    esac\n"
         "  done\n"
         "  case \"$chain\" in\n";
  write_words(out, app, "");
  out << "  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$cur\")\n"
         "  if [[ $cur != -* && -n $chain ]]; then\n"
         "    mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- \"$cur\")\n"
         "  fi\n"
         "}\n"
         "complete -o filenames -F _grainvdb grainvdb\n";
}

}  // namespace

void add_completion(CLI::App& app) {
  CLI::App* command = app.add_subcommand("completion", "Print a script that lets bash complete commands and options");
  command->footer(completion_footer);
  command->callback([&app] { write_completion(std::cout, app); });
}

}  // namespace grainvdb::cli
