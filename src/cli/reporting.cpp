#include "cli/reporting.hpp"

#include <iostream>

#include "cli/interrupt.hpp"
#include "cli/progress_line.hpp"

namespace grainvdb::cli {

void add_log_option(CLI::App& command, Reporting& reporting) {
  command.add_flag("--log-json", reporting.log_json,
                   "Write progress, warnings and errors as JSON, an object a line, to the standard error");
}

ProgressViews::ProgressViews(const Reporting& reporting) {
  if (!reporting.progress_file.empty()) views_.push_back(std::make_unique<ProgressFile>(reporting.progress_file));
  if (reporting.log_json) {
    views_.push_back(std::make_unique<ProgressLog>());
  } else if (!reporting.quiet) {
    views_.push_back(std::make_unique<ProgressLine>(stderr));
  }
}

void ProgressViews::show(const Progress& progress) const {
  check_for_interrupt();
  for (const auto& view : views_) view->show(progress);
}

void warn(const Reporting& reporting, const std::string& warnings) {
  if (reporting.log_json)
    log_warnings(warnings);
  else
    std::cerr << warnings;
}

}  // namespace grainvdb::cli
