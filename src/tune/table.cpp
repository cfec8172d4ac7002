#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <numeric>
#include <sstream>

#include "base/listed.hpp"
#include "grainvdb/tune.hpp"

namespace grainvdb {
namespace {

std::ostringstream stream(int digits) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(digits);
  return text;
}

std::string number(double x, int digits = 3) {
  if (std::isinf(x)) return "-";
  std::ostringstream text = stream(digits);
  text << x;
  return text.str();
}

/// As a shell takes it: a value with brackets, spaces or asterisks in quotes.
std::string as_option(const std::string& set) {
  return "--set " + (set.find_first_of("[]{}()*?'\"$&;<>| ") == std::string::npos ? set : '\'' + set + '\'');
}

using Row = std::vector<std::string>;

std::string aligned(const std::vector<Row>& rows) {
  std::vector<std::size_t> width(rows.front().size(), 0);
  for (const Row& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  std::ostringstream text = stream(6);
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string pad(width[c] - row[c].size(), ' ');
      const bool last = c + 1 == row.size();  // the setting, to the left
      line += (c > 0 ? "  " : "") + (last ? row[c] : pad + row[c]);
    }
    text << line << '\n';
  }
  return text.str();
}

std::vector<std::size_t> by_time(const std::vector<Trial>& trials) {
  std::vector<std::size_t> order(trials.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return trials[a].best_seconds() < trials[b].best_seconds(); });
  return order;
}

std::string tolerances(const std::map<std::string, double>& tolerance) {
  return listed(tolerance, [](const auto& of) { return of.first + ' ' + number(of.second); });
}

std::string table(const TuneReport& report, const std::map<std::string, double>& tolerance) {
  const double now = report.trials.front().best_seconds();
  Row header{"", "time [s]", "of now"};
  header.insert(header.end(), report.fields.begin(), report.fields.end());
  header.emplace_back("setting");
  std::vector<Row> rows{header};
  for (std::size_t t : by_time(report.trials)) {
    const Trial& trial = report.trials[t];
    if (!trial.refused.empty()) continue;
    const bool chosen = t == report.proposed && !tolerance.empty() && report.proposal_meets;
    Row row{std::string(report.front[t] ? "*" : " ") + (t == 0   ? "="
                                                        : chosen ? ">"
                                                                 : " "),
            number(trial.best_seconds()), number(trial.best_seconds() / now)};
    for (const FieldError& e : trial.errors) row.push_back(e.points > 0 ? number(e.rms, 2) : "-");
    row.push_back(trial.name());
    rows.push_back(row);
  }
  return aligned(rows);
}

bool compares(const TuneReport& report, const std::string& prefix) {
  return std::any_of(report.fields.begin(), report.fields.end(),
                     [&](const std::string& name) { return name.starts_with(prefix); });
}

std::string what_it_shows(const TuneReport& report) {
  std::string text;
  if (report.reference_points > 0)
    text += "Errors: sqrt(sum |f - r|^2 / sum |r|^2), ratios weighted with phi, at " +
            std::to_string(report.reference_points) +
            " points between the voxel centres, to\nwhich f is interpolated. ";
  text += "r is from a reference run with\n ";
  for (const std::string& s : report.reference) text += ' ' + s;
  if (compares(report, "profile."))
    text +=
        "\nprofile: the same sum over planes, against the exact averages of all frames at the planes of the setting";
  if (compares(report, "position"))
    text += "\nposition: rms distance of tracers at the end from those of the reference, in mean diameters";
  text += "\n* nothing is both faster and closer, = the current setting, > the proposed one\n";
  const FieldError* lost = nullptr;
  for (const FieldError& e : report.trials.front().errors)
    if (e.undefined > 0 && (lost == nullptr || e.undefined > lost->undefined)) lost = &e;
  if (lost != nullptr)
    text += "Points where the reference alone has a value are left out: at the current setting up to " +
            std::to_string(lost->undefined) + " (" + lost->field + ")\n";
  if (!report.not_compared.empty()) {
    text += "Not compared:";
    for (const std::string& field : report.not_compared) text += ' ' + field;
    text += '\n';
  }
  for (const Trial& trial : report.trials)
    if (!trial.refused.empty()) text += "Not possible: " + trial.name() + ": " + trial.refused + '\n';
  return text;
}

std::string proposal(const TuneReport& report, const std::map<std::string, double>& tolerance) {
  const Trial& now = report.trials.front();
  if (tolerance.empty()) return "Name what is good enough to have a setting proposed: --tolerance phi=1e-3,...\n";
  if (!report.proposal_meets) {
    const auto closest =
        std::min_element(report.trials.begin(), report.trials.end(),
                         [&](const Trial& a, const Trial& b) { return score(a, tolerance) < score(b, tolerance); });
    std::string text =
        "Nothing that was tried keeps to " + tolerances(tolerance) + ". The closest, " + closest->name() + ", misses:";
    for (const FieldError& e : closest->errors)
      if (const auto it = tolerance.find(e.field); it != tolerance.end() && !(e.rms <= it->second))
        text += ' ' + e.field + ' ' + number(e.rms, 2);
    return text + '\n';
  }
  const Trial& best = report.trials[report.proposed];
  if (best.set.empty())
    return "The current setting keeps to " + tolerances(tolerance) +
           ", and none of those tried that do was faster in every repeat.\n";
  std::string text = "The fastest of those tried that keep to " + tolerances(tolerance) + ": " +
                     number(best.best_seconds()) + " s, " + number(best.best_seconds() / now.best_seconds(), 2) +
                     " of the time now\n ";
  for (const std::string& s : best.set) text += ' ' + as_option(s);
  text += '\n';
  std::string other;
  for (const FieldError& e : best.errors)
    if (!tolerance.contains(e.field)) other += (other.empty() ? "" : ", ") + e.field + ' ' + number(e.rms, 2);
  if (!other.empty()) text += "Without a tolerance: " + other + '\n';
  return text;
}

}  // namespace

std::string describe(const TuneReport& report, const std::map<std::string, double>& tolerance) {
  return table(report, tolerance) + what_it_shows(report) + proposal(report, tolerance);
}

std::string describe(const TunePlan& plan) {
  std::string text = "would make at most " + std::to_string(plan.runs) + (plan.runs == 1 ? " run" : " runs") +
                     ", and compare " + listed(plan.fields) + '\n';
  if (!plan.not_compared.empty()) text += "not compared: " + listed(plan.not_compared) + '\n';
  text += "reference:";
  for (const std::string& s : plan.reference) text += ' ' + s;
  text += "\nsettings, each by itself:\n";
  for (const Trial& trial : plan.settings)
    text += "  " + trial.name() + (trial.refused.empty() ? "" : ": not possible: " + trial.refused) + '\n';
  return text;
}

std::string to_csv(const TuneReport& report, const std::map<std::string, double>& tolerance) {
  std::ostringstream text = stream(9);
  text << "setting,current,proposed,front,best_seconds,worst_seconds,repeats,field,rms,largest,points,undefined,"
          "tolerance\n";
  for (std::size_t t = 0; t < report.trials.size(); ++t) {
    const Trial& trial = report.trials[t];
    if (!trial.refused.empty()) continue;
    const bool chosen = t == report.proposed && !tolerance.empty() && report.proposal_meets;
    for (const FieldError& e : trial.errors) {
      text << '"' << (trial.set.empty() ? "" : trial.name()) << "\"," << (t == 0) << ',' << chosen << ','
           << report.front[t] << ',' << trial.best_seconds() << ',' << trial.worst_seconds() << ','
           << trial.seconds.size() << ',' << e.field << ',' << e.rms << ',' << e.largest << ',' << e.points << ','
           << e.undefined << ',';
      if (const auto it = tolerance.find(e.field); it != tolerance.end()) text << it->second;
      text << '\n';
    }
  }
  return text.str();
}

}  // namespace grainvdb
