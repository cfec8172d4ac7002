/// Help, version, and what the command says about itself.
#include <cstdlib>
#include <regex>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"

namespace grainvdb::test::usage_test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

CommandResult grainvdb(const std::vector<std::string>& arguments) {
  const Folder folder;
  return run_command(arguments, folder.path());
}

TEST(Usage, EveryCommandHasHelpWithExamples) {
  for (const char* command : {"run", "trace", "measure", "info", "init", "validate", "stages", "measurements", "graph",
                              "schema", "spot", "report", "tune", "completion", "man"}) {
    const CommandResult result = grainvdb({command, "--help"});
    EXPECT_EQ(result.exit_code, 0) << command;
    EXPECT_THAT(result.out,
                AllOf(ContainsRegex("\nExamples:\n  .*grainvdb " + std::string(command)), HasSubstr("--help")));
    EXPECT_EQ(result.err, "");
  }
}

TEST(Usage, CommandsThatTakeLongCanBeTriedAndLogged) {
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"run"}, {"trace"}, {"measure"}, {"tune"}, {"spot", "run"}, {"spot", "calibrate"}}) {
    std::vector<std::string> words = command;
    words.emplace_back("--help");
    EXPECT_THAT(grainvdb(words).out, AllOf(HasSubstr("--dry-run "), HasSubstr("--log-json "))) << command.back();
  }
}

TEST(Usage, HelpDocumentsCommandsAndExitCodes) {
  const CommandResult result = grainvdb({"--help"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* word : {"run", "measure", "info", "init", "validate", "stages", "measurements", "graph", "schema",
                           "spot", "report", "Exit codes:", "  0 ", "  1 ", "  2 ", "  3 ", "  4 ", "  5 ", "  130 "})
    EXPECT_THAT(result.out, HasSubstr(word));
}

TEST(Usage, PrintsItsVersion) {
  const CommandResult result = grainvdb({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, testing::MatchesRegex("grainvdb [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(Usage, BadCommandLinesExitWithOne) {
  const CommandResult none = grainvdb({});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, AllOf(StartsWith("grainvdb: "), HasSubstr("--help")));

  const CommandResult command = grainvdb({"rnu", "p.yaml"});
  EXPECT_EQ(command.exit_code, 1);
  EXPECT_THAT(command.err, StartsWith("grainvdb: unknown command 'rnu'. Did you mean 'run'?\n"));
  EXPECT_EQ(command.out, "");

  const CommandResult option = grainvdb({"run", "p.yaml", "--treads", "2"});
  EXPECT_EQ(option.exit_code, 1);
  EXPECT_THAT(option.err, StartsWith("grainvdb: unknown option '--treads'. Did you mean '--threads'?\n"));

  const CommandResult missing = grainvdb({"run"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.err, HasSubstr("pipeline"));

  const CommandResult extra = grainvdb({"graph", "a.yaml", "b.yaml"});
  EXPECT_EQ(extra.exit_code, 1);
  EXPECT_THAT(extra.err, StartsWith("grainvdb: unexpected argument 'b.yaml'\n"));

  const CommandResult below = grainvdb({"spot", "rum"});
  EXPECT_EQ(below.exit_code, 1);
  EXPECT_THAT(below.err, AllOf(StartsWith("grainvdb: unknown command 'rum'. Did you mean 'run'?\n"),
                               HasSubstr("'grainvdb spot --help'")));

  const CommandResult elsewhere = grainvdb({"measure", "p.yaml", "--resume"});
  EXPECT_EQ(elsewhere.exit_code, 1);
  EXPECT_THAT(elsewhere.err, StartsWith("grainvdb: unknown option '--resume'. It is an option of 'grainvdb run'.\n"));

  const CommandResult number = grainvdb({"info", "d.txt", "--dt", "-1"});
  EXPECT_EQ(number.exit_code, 1);
  EXPECT_THAT(number.err, StartsWith("grainvdb: --dt: '-1' is not a number > 0\n"));
}

TEST(Usage, TheManualPageHasEveryCommandAndOption) {
  const CommandResult result = grainvdb({"man"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, AllOf(StartsWith(".TH GRAINVDB 1"), HasSubstr(".SS grainvdb spot run\n"),
                                HasSubstr(".SS grainvdb spot calibrate\n"),
                                HasSubstr("\\fB\\-o,\\-\\-output\\fR \\fIDIR\\fR"), HasSubstr("Exit codes:")));
  for (const char* command :
       {"run", "measure", "info", "init", "validate", "stages", "measurements", "graph", "schema", "spot", "report"})
    EXPECT_THAT(result.out, HasSubstr(".SS grainvdb " + std::string(command) + '\n'));
  // A line of text that began with a dot would be a request.
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(!line.starts_with('.') || std::regex_match(line, std::regex("\\.(TH|SH|SS|TP|PP|nf|fi)( .*)?")))
        << line;
}

// What bash offers when the words are typed and the last one is to be completed.
std::string completed(const std::string& words) {
  const Folder folder;
  folder.write("my pipeline.yaml", "");
  const CommandResult script = run_command({"completion"}, folder.path());
  folder.write("complete.sh", script.out + "COMP_WORDS=(" + words +
                                  ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_grainvdb\n"
                                  "printf '%s\\n' \"${COMPREPLY[@]}\"\n");
  const std::string out = folder / "out.txt";
  const std::string shell = "cd '" + folder.path().string() + "' && bash complete.sh > out.txt";
  EXPECT_EQ(std::system(shell.c_str()), 0);
  return read_file(out);
}

TEST(Usage, BashCompletesCommandsOptionsAndFiles) {
  EXPECT_EQ(completed("grainvdb inf"), "info\n");
  EXPECT_EQ(completed("grainvdb run --th"), "--threads\n");
  EXPECT_EQ(completed("grainvdb run my"), "my pipeline.yaml\n");
  EXPECT_EQ(completed("grainvdb spot ru"), "run\n");
  EXPECT_EQ(completed("grainvdb spot ca"), "calibrate\n");
  EXPECT_EQ(completed("grainvdb spot calibrate --fr"), "--frames\n");
  EXPECT_EQ(completed("grainvdb spot run --qu"), "--quiet\n");
  for (const std::string command : {"tune", "spot run", "spot calibrate"}) {
    EXPECT_EQ(completed("grainvdb " + command + " --dry"), "--dry-run\n");
    EXPECT_EQ(completed("grainvdb " + command + " --log"), "--log-json\n");
  }
  EXPECT_EQ(completed("grainvdb run run --dt"), "\n");
}

TEST(Usage, ThreadsMustBeAPositiveNumber) {
  for (const char* bad : {"0", "-1", "two", "1.5", ""}) {
    const CommandResult result = grainvdb({"run", "p.yaml", "--threads", bad});
    EXPECT_EQ(result.exit_code, 1) << bad;
    EXPECT_THAT(result.err, HasSubstr("--threads")) << bad;
  }
}

TEST(Usage, AFullStandardOutputIsAnIoError) {
  const Folder folder;
  const CommandResult result = run_command({"stages"}, folder.path(), "/dev/full");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("cannot write to the standard output"));
}

TEST(Stages, AreListedInEveryForm) {
  const CommandResult table = grainvdb({"stages"});
  EXPECT_EQ(table.exit_code, 0);
  EXPECT_THAT(table.out, AllOf(HasSubstr("\nvelocity "), HasSubstr("contact_stress"), HasSubstr("(A14, A15)")));

  const CommandResult json = grainvdb({"stages", "--json"});
  EXPECT_EQ(json.exit_code, 0);
  const auto stages = nlohmann::json::parse(json.out);
  const auto named = [&](const std::string& name) {
    for (const auto& stage : stages)
      if (stage["name"] == name) return stage;
    return nlohmann::json();
  };
  EXPECT_EQ(named("phi")["reads"], nlohmann::json::parse(R"(["id", "position", "radius"])"));
  EXPECT_EQ(named("velocity")["unit"], "m/s");
  EXPECT_EQ(named("kinetic_stress")["sweeps"], 2);
  EXPECT_EQ(named("stress")["components"], 9);
  EXPECT_THAT(named("stress")["needs"].dump(), AllOf(HasSubstr("contact_stress"), HasSubstr("kinetic_stress")));
  EXPECT_EQ(named("temperature")["options"][0]["default"], "two_pass");

  const CommandResult markdown = grainvdb({"stages", "--markdown"});
  EXPECT_EQ(markdown.exit_code, 0);
  EXPECT_THAT(markdown.out, HasSubstr("\n| `phi` | 1 | 1 | "));
  for (std::size_t line = 0, end; (end = markdown.out.find('\n', line)) != std::string::npos; line = end + 1) {
    int bars = 0;
    for (std::size_t i = line; i < end; ++i)
      bars += markdown.out[i] == '|' && (i == line || markdown.out[i - 1] != '\\') ? 1 : 0;
    EXPECT_EQ(bars, 8) << markdown.out.substr(line, end - line);
  }
}

TEST(Stages, OneIsShownInFull) {
  const CommandResult result = grainvdb({"stages", "temperature"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("option mode (text, default \"two_pass\")"), HasSubstr("two_pass_profile")));
  const CommandResult unknown = grainvdb({"stages", "temprature"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err,
              AllOf(StartsWith("grainvdb: there is no stage 'temprature'"), HasSubstr("Did you mean 'temperature'?")));
}

TEST(SchemaCommand, PrintsJsonAndText) {
  const CommandResult json = grainvdb({"schema"});
  EXPECT_EQ(json.exit_code, 0);
  const auto schema = nlohmann::json::parse(json.out);
  EXPECT_TRUE(schema["properties"]["stages"]["properties"]["temperature"]["properties"].contains("mode"));
  const CommandResult text = grainvdb({"schema", "--text"});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.out,
              AllOf(HasSubstr("input:  (required)"), HasSubstr("  cutoff: number  (required)"), HasSubstr("[length]")));
}

TEST(SchemaCommand, PrintsThatOfSpotFiles) {
  const CommandResult json = grainvdb({"schema", "--spot"});
  EXPECT_EQ(json.exit_code, 0);
  const auto schema = nlohmann::json::parse(json.out);
  EXPECT_EQ(schema["title"], "grainvdb spot file");
  EXPECT_TRUE(schema["properties"]["spots"]["properties"]["bias"]["properties"].contains("exponent"));
  const CommandResult text = grainvdb({"schema", "--spot", "--text"});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.out, AllOf(HasSubstr("container:  (required)"), HasSubstr("voids:"), HasSubstr("[1/time]")));
}

TEST(Graph, ShowsWhatWouldRunWithoutTheDumps) {
  const Folder folder;
  folder.write("p.yaml", pipeline_text());  // no dumps
  const CommandResult text = run_command({"graph", "p.yaml"}, folder.path());
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out,
              AllOf(HasSubstr("reads id, position, velocity, radius"), HasSubstr("not read: "), HasSubstr("contacts")));
  const CommandResult phi = run_command({"graph", "p.yaml", "--set", "output.fields=[phi]"}, folder.path());
  EXPECT_THAT(phi.out, AllOf(HasSubstr("reads id, position, radius\n"), HasSubstr("written: phi as hdf5")));
  const CommandResult dot = run_command({"graph", "p.yaml", "--dot"}, folder.path());
  EXPECT_THAT(dot.out, AllOf(StartsWith("digraph grainvdb {"), HasSubstr("\"field:phi\" -> \"output\"")));
}

}  // namespace
}  // namespace grainvdb::test::usage_test
