#include <memory>
#include <string>

#include "cli/commands.hpp"
#include "cli/python.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* page_footer = R"(Examples:
  grainvdb report output
  grainvdb report output --cut y --at 0.0032 --axis z
  grainvdb report output --output for-the-group --fitted 2.0 0.584 0.845e-4 0.0377

The page report.html holds everything and can be sent as it is; the pictures lie beside it as PNG files. Needs h5py and
matplotlib, on Debian the packages python3-h5py and python3-matplotlib.)";

struct PageOptions {
  std::string folder, output, axis, cut;
  std::string at;
  std::vector<std::string> fitted;
};

void report(const PageOptions& options) {
  std::vector<std::string> arguments{options.folder};
  const auto pass = [&](const char* name, const std::string& value) {
    if (!value.empty()) arguments.push_back(std::string(name) + '=' + value);
  };
  pass("--output", options.output);
  pass("--axis", options.axis);
  pass("--cut", options.cut);
  pass("--at", options.at);
  if (!options.fitted.empty()) {
    arguments.emplace_back("--fitted");
    arguments.insert(arguments.end(), options.fitted.begin(), options.fitted.end());
  }
  become_python("grainvdb.report", arguments, {"h5py", "matplotlib"});
}

}  // namespace

void add_report(CLI::App& app) {
  CLI::App* command = app.add_subcommand("report", "Make a page with pictures from a result");
  const auto options = std::make_shared<PageOptions>();
  const CLI::IsMember axes({"x", "y", "z"});
  command->add_option("result", options->folder, "The output folder of a run")->required()->type_name("DIR");
  command->add_option("-o,--output", options->output, "Folder for the page; DIR/report unless given")->type_name("DIR");
  command->add_option("--axis", options->axis, "Axis of the profiles; z unless given")->type_name("x|y|z")->check(axes);
  command
      ->add_option("--cut", options->cut,
                   "Axis across which slices are taken; that with the fewest voxels unless given")
      ->type_name("x|y|z")
      ->check(axes);
  command->add_option("--at", options->at, "Where the slices are taken [length]; the fullest layer unless given")
      ->type_name("X")
      ->check(CLI::Number);
  command->add_option("--fitted", options->fitted, "Parameters A B C D of (A20) to draw beside the law (3)")
      ->type_name("A B C D")
      ->expected(4)
      ->check(CLI::Number);
  command->footer(page_footer);
  command->callback([options] { report(*options); });
}

}  // namespace grainvdb::cli
