#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <thread>

#include <malloc.h>

#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/subcommands.hpp"
#include "grainvdb/error.hpp"
#include "grainvdb/version.hpp"
#include "pipeline/text.hpp"

namespace grainvdb::cli {
namespace {

enum ExitCode { bad_usage = 1, io_failed = 3, limit_refused = 4, unexpected = 5 };

constexpr const char* main_footer = R"(Examples:
  grainvdb info dumps/
  grainvdb init dumps/ --output my.yaml
  grainvdb validate pipelines/shear_cell.yaml
  grainvdb run pipelines/shear_cell.yaml --output result
  grainvdb run pipelines/shear_cell.yaml --set kernel.cutoff=3e-3 --frames ::2
  grainvdb trace pipelines/silo_elements.yaml --output result
  grainvdb measure pipelines/structure.yaml --output result
  grainvdb report result

Exit codes:
  0    done
  1    bad usage, or a pipeline file that cannot be run as written
  2    bad input: a dump is malformed, or lacks what the pipeline needs
  3    the operating system refused to open, read or write a file
  4    a limit was exceeded, or memory ran out
  5    an unexpected failure inside grainvdb
  130  interrupted (128 plus the number of the signal))";

int fail(int code, const std::string& message) {
  std::cout.flush();
  std::cerr << "grainvdb: " << message << '\n';
  return code;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : subcommands_of(app)) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

bool has_option(const CLI::App& command, const std::string& name) {
  return name.starts_with("--") && command.get_option_no_throw(name) != nullptr;
}

// " It is an option of 'grainvdb run'."; empty where no command has it.
std::string other_command_with(const CLI::App& app, const std::string& option) {
  std::string commands;
  for (const CLI::App* command : subcommands_of(app))
    if (has_option(*command, option))
      commands += (commands.empty() ? "" : ", ") + quote_text("grainvdb " + command->get_name());
  return commands.empty() ? "" : "It is an option of " + commands + '.';
}

// The innermost command that was named.
const CLI::App& called(const CLI::App& app) {
  const auto named = app.get_subcommands();
  return named.empty() ? app : called(*named.front());
}

// What is wrong with the first word that was not understood.
std::string unknown_word(const CLI::App& app, const std::string& word) {
  const bool is_option = word.starts_with('-');
  const CLI::App& command = called(app);
  const bool is_command = !is_option && !subcommands_of(command).empty();
  const std::string option = word.substr(0, word.find('='));
  std::string guess;
  if (is_option) guess = did_you_mean(option, option_names(command));
  if (is_option && guess.empty()) guess = other_command_with(app, option);
  if (is_command) guess = did_you_mean(word, command_names(command));
  const char* kind = is_option ? "unknown option " : is_command ? "unknown command " : "unexpected argument ";
  return kind + quote_text(word) + (guess.empty() ? "" : ". " + guess);
}

int bad_command_line(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> rest = app.remaining(true);
  std::string command = "grainvdb";
  for (const CLI::App* sub = &app; !sub->get_subcommands().empty();) {
    sub = sub->get_subcommands().front();
    command += ' ' + sub->get_name();
  }
  return fail(bad_usage, (rest.empty() ? error.what() : unknown_word(app, rest.front())) + "\nRun '" + command +
                             " --help' for usage.");
}

// What the memory of a run is must not depend on how long it takes. Columns of frames go back to the system when a
// frame is done; otherwise the allocator learns from the first ones to keep what is smaller than 32 MB in its heaps.
// And threads share heaps: with one each, what one frees is of no use to the others, and the holes grow from frame to
// frame.
void bound_heaps() {
#ifdef __GLIBC__
  constexpr int large = 4 << 20;
  constexpr unsigned threads_of_a_heap = 8;  // more of them would wait for one another
  mallopt(M_MMAP_THRESHOLD, large);
  mallopt(M_ARENA_MAX, 1 + static_cast<int>(std::thread::hardware_concurrency() / threads_of_a_heap));
#endif
}

int run(int argc, char** argv) {
  bound_heaps();
  CLI::App app("Continuum fields from particle snapshots of granular flow.", "grainvdb");
  app.set_version_flag("--version", "grainvdb " GRAINVDB_VERSION);
  app.footer(main_footer);
  app.require_subcommand(1);
  add_run(app);
  add_trace(app);
  add_measure(app);
  add_info(app);
  add_init(app);
  add_validate(app);
  add_stages(app);
  add_measurements(app);
  add_graph(app);
  add_schema(app);
  add_spot(app);
  add_report(app);
  add_tune(app);
  add_completion(app);
  add_man(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wanted) {  // --help and --version
    app.exit(wanted, std::cout, std::cerr);
  } catch (const CLI::RuntimeError& said) {  // the command has said what is wrong
    std::cout.flush();
    return said.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return bad_command_line(app, error);
  } catch (const Error& error) {
    return fail(error.exit_code(), error.what());
  } catch (const Interrupted& interrupted) {
    return fail(128 + interrupted.signal, "interrupted; nothing was written");
  } catch (const std::bad_alloc&) {
    return fail(limit_refused, "memory ran out. Use larger voxels, fewer fields or a smaller region.");
  } catch (const std::exception& error) {
    return fail(unexpected, std::string("unexpected failure: ") + error.what());
  }
  if (!std::cout.flush()) return fail(io_failed, "cannot write to the standard output");
  return 0;
}

}  // namespace

void add_pipeline_arguments(CLI::App& command, PipelineArguments& arguments, const FileArgument& file) {
  command.add_option(file.name, arguments.file, file.help)->required()->type_name(file.type);
  command
      .add_option("--set", arguments.overrides,
                  std::string("Set a key of the file, e.g. ") + file.keys +
                      "; SECTION=null leaves a section out; wins over the file, may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->take_all();
}

void add_frames_option(CLI::App& command, PipelineArguments& arguments) {
  command.add_option("--frames", arguments.frames, "Frames first:end:step, short for --set frames=...")
      ->type_name("A:B:C");
}

std::vector<std::string> PipelineArguments::settings() const {
  std::vector<std::string> all = overrides;
  if (!frames.empty()) all.push_back("frames=" + frames);
  return all;
}

}  // namespace grainvdb::cli

int main(int argc, char** argv) {
  return grainvdb::cli::run(argc, argv);
}
