#include <memory>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/python.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* page_footer = R"(Examples:
  grainvdb report output
  grainvdb report output --cut y --at 0.0032 --axis z
  grainvdb report output --output for-the-group --fitted 2.0 0.584 0.845e-4 0.0377
  grainvdb report dem --beside spot --label DEM "spot model"

With --beside, one page sets several results side by side: numbers with the difference in standard errors, curves on the
same axes, slices and maps on one colour scale. Results in different units are refused.
The page report.html holds everything and can be sent as it is; the pictures lie beside it as PNG files. Needs h5py and
matplotlib, on Debian the packages python3-h5py and python3-matplotlib.)";

struct PageOptions {
  std::string folder, output, axis, cut;
  std::string at;
  std::vector<std::string> fitted, beside, labels;
};

void report(const PageOptions& options) {
  if (!options.labels.empty() && options.labels.size() != options.beside.size() + 1)
    throw CLI::ValidationError("--label", "names each result once: DIR, then those of --beside");
  std::vector<std::string> arguments{options.folder};
  const auto pass = [&](const char* name, const std::string& value) {
    if (!value.empty()) arguments.push_back(std::string(name) + '=' + value);
  };
  pass("--output", options.output);
  pass("--axis", options.axis);
  pass("--cut", options.cut);
  pass("--at", options.at);
  const auto pass_all = [&](const char* name, const std::vector<std::string>& values) {
    if (values.empty()) return;
    arguments.emplace_back(name);
    arguments.insert(arguments.end(), values.begin(), values.end());
  };
  pass_all("--fitted", options.fitted);
  pass_all("--beside", options.beside);
  pass_all("--label", options.labels);
  become_python("grainvdb.report", arguments, {"h5py", "matplotlib"});
}

}  // namespace

void add_report(CLI::App& app) {
  CLI::App* command = app.add_subcommand("report", "Make a page with pictures from a result");
  const auto options = std::make_shared<PageOptions>();
  const CLI::IsMember axes({"x", "y", "z"});
  command->add_option("result", options->folder, "The output folder of a run")->required()->type_name("DIR");
  command->add_option("-o,--output", options->output, "Folder for the page; DIR/report, or DIR/beside, unless given")
      ->type_name("DIR");
  command->add_option("--axis", options->axis, "Axis of the profiles; z unless given")->type_name("x|y|z")->check(axes);
  command
      ->add_option("--cut", options->cut,
                   "Axis across which slices are taken; that with the fewest voxels unless given")
      ->type_name("x|y|z")
      ->check(axes);
  command->add_option("--at", options->at, "Where the slices are taken [length]; the fullest layer unless given")
      ->type_name("X")
      ->check(CLI::Number);
  CLI::Option* fitted =
      command->add_option("--fitted", options->fitted, "Parameters A B C D of (A20) to draw beside the law (3)")
          ->type_name("A B C D")
          ->expected(4)
          ->check(CLI::Number);
  CLI::Option* beside = command->add_option("--beside", options->beside, "Other results to set beside this one")
                            ->type_name("OTHER ...")
                            ->expected(1, -1)
                            ->excludes(fitted);
  command
      ->add_option("--label", options->labels,
                   "What the results are called, that of DIR first; the names of their folders unless given")
      ->type_name("NAME ...")
      ->expected(2, -1)
      ->needs(beside);
  command->footer(page_footer);
  command->callback([options] { report(*options); });
}

}  // namespace grainvdb::cli
