#pragma once
/// How a command that takes long tells how far it is, and what is wrong.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/error_json.hpp"
#include "cli/progress_json.hpp"
#include "cli/progress_view.hpp"
#include "grainvdb/error.hpp"

namespace grainvdb::cli {

struct Reporting {
  std::string progress_file;  ///< empty: none
  bool log_json = false;
  bool quiet = false;
};

/// The option --log-json.
void add_log_option(CLI::App& command, Reporting& reporting);

/// Shows the progress of one piece of work, whose time counts from here on.
class ProgressViews {
 public:
  explicit ProgressViews(const Reporting& reporting);
  /// Throws Interrupted where the user has interrupted the work, IoError.
  void show(const Progress& progress) const;

 private:
  std::vector<std::unique_ptr<ProgressView>> views_;
};

/// On the standard error, a line each.
void warn(const Reporting& reporting, const std::string& warnings);

/// work(); its errors are events, too, where events are logged.
template <class F>
void with_errors_logged(const Reporting& reporting, F work) {
  if (!reporting.log_json) return work();
  try {
    work();
  } catch (const Error& error) {
    log_event("error", error_json(error));
    throw CLI::RuntimeError(error.exit_code());
  }
}

}  // namespace grainvdb::cli
