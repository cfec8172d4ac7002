#include "tune/proposal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainvdb {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double rms_of(const Trial& trial, const std::string& field) {
  for (const FieldError& e : trial.errors)
    if (e.field == field) return e.points > 0 ? e.rms : infinite;
  return infinite;
}

/// Whether a trial's error of any field with a tolerance differs from the current setting's.
bool concerns(const Trial& trial, const Trial& current, const Tolerances& tolerance) {
  return std::any_of(tolerance.begin(), tolerance.end(), [&](const auto& t) {
    const double now = rms_of(current, t.first);
    return std::abs(rms_of(trial, t.first) - now) > 0.01 * now;
  });
}

/// Grows combinations by a value of each knob in turn, and gives up those that cannot become one of the fastest within
/// the tolerances whatever the later knobs bring.
class Search {
 public:
  Search(const std::vector<Trial>& trials, const std::vector<std::string>& knob_of, const Tolerances& tolerance,
         std::size_t most)
      : trials_(trials), most_(most) {
    for (const auto& [field, bound] : tolerance) {
      fields_.push_back(field);
      squares_.push_back(bound * bound);
    }
    for (std::size_t t = 1; t < trials.size(); ++t) {
      const bool measured = trials[t].knobs == 1 && std::isfinite(score(trials[t], tolerance));
      if (!measured || !concerns(trials[t], trials[0], tolerance)) continue;
      if (steps_.empty() || knob_of[steps_.back().front().trial] != knob_of[t]) steps_.emplace_back();
      steps_.back().push_back(step(t));
    }
    // What the knobs from each on can do at best.
    best_.assign(steps_.size() + 1, {0, 1, std::vector<double>(fields_.size(), 0.0)});
    for (std::size_t k = steps_.size(); k-- > 0;) {
      Step least{0, 1, std::vector<double>(fields_.size(), 0.0)};
      for (const Step& s : steps_[k]) {
        least.ratio = std::min(least.ratio, s.ratio);
        for (std::size_t f = 0; f < fields_.size(); ++f) least.squares[f] = std::min(least.squares[f], s.squares[f]);
      }
      best_[k].ratio = best_[k + 1].ratio * least.ratio;
      for (std::size_t f = 0; f < fields_.size(); ++f) best_[k].squares[f] = best_[k + 1].squares[f] + least.squares[f];
    }
  }

  std::vector<Combination> run() {
    std::vector<double> now;
    for (const std::string& field : fields_) now.push_back(std::pow(rms_of(trials_[0], field), 2));
    grow({{}, trials_[0].best_seconds()}, now, 0);
    return std::move(found_);
  }

 private:
  /// What a value changes: the factor on the time, the terms on the squares of the errors.
  struct Step {
    std::size_t trial;
    double ratio;
    std::vector<double> squares;
  };

  Step step(std::size_t t) const {
    Step s{t, trials_[t].best_seconds() / trials_[0].best_seconds(), {}};
    for (const std::string& field : fields_)
      s.squares.push_back(std::pow(rms_of(trials_[t], field), 2) - std::pow(rms_of(trials_[0], field), 2));
    return s;
  }

  void grow(const Combination& so_far, const std::vector<double>& squares, std::size_t knob) {
    const bool full = found_.size() == most_;
    if (full && so_far.seconds * best_[knob].ratio >= found_.back().seconds) return;
    for (std::size_t f = 0; f < fields_.size(); ++f)
      if (squares[f] + best_[knob].squares[f] > squares_[f]) return;
    if (knob == steps_.size()) {
      if (so_far.trials.size() < 2) return;
      const auto slower = [](const Combination& a, const Combination& b) { return a.seconds < b.seconds; };
      found_.insert(std::upper_bound(found_.begin(), found_.end(), so_far, slower), so_far);
      if (found_.size() > most_) found_.pop_back();
      return;
    }
    grow(so_far, squares, knob + 1);
    for (const Step& s : steps_[knob]) {
      Combination next = so_far;
      next.trials.push_back(s.trial);
      next.seconds *= s.ratio;
      std::vector<double> changed = squares;
      for (std::size_t f = 0; f < changed.size(); ++f) changed[f] += s.squares[f];
      grow(next, changed, knob + 1);
    }
  }

  const std::vector<Trial>& trials_;
  std::size_t most_;
  std::vector<std::string> fields_;
  std::vector<double> squares_;  // of the tolerances
  std::vector<std::vector<Step>> steps_;
  std::vector<Step> best_;
  std::vector<Combination> found_;  // the fastest first
};

}  // namespace

double Trial::best_seconds() const {
  return seconds.empty() ? infinite : *std::min_element(seconds.begin(), seconds.end());
}

double Trial::worst_seconds() const {
  return seconds.empty() ? infinite : *std::max_element(seconds.begin(), seconds.end());
}

std::string Trial::name() const {
  std::string text;
  for (const std::string& s : set) {
    if (!text.empty()) text += ' ';
    text += s;
  }
  return text.empty() ? "as it is" : text;
}

double score(const Trial& trial, const Tolerances& tolerance) {
  if (!trial.refused.empty()) return infinite;
  double worst = 0;
  if (tolerance.empty()) {
    for (const FieldError& e : trial.errors) worst = std::max(worst, rms_of(trial, e.field));
  } else {
    for (const auto& [field, most] : tolerance) worst = std::max(worst, rms_of(trial, field) / most);
  }
  return worst;
}

bool meets(const Trial& trial, const Tolerances& tolerance) {
  return trial.refused.empty() && std::all_of(tolerance.begin(), tolerance.end(),
                                              [&](const auto& t) { return rms_of(trial, t.first) <= t.second; });
}

std::vector<bool> pareto_front(const std::vector<Trial>& trials, const Tolerances& tolerance) {
  std::vector<bool> front(trials.size());
  for (std::size_t a = 0; a < trials.size(); ++a) {
    const double seconds = trials[a].best_seconds();
    const double error = score(trials[a], tolerance);
    front[a] = trials[a].refused.empty() && std::none_of(trials.begin(), trials.end(), [&](const Trial& b) {
                 const double other = score(b, tolerance);
                 return b.refused.empty() && b.best_seconds() <= seconds && other <= error &&
                        (b.best_seconds() < seconds || other < error);
               });
  }
  return front;
}

std::vector<Combination> promising(const std::vector<Trial>& trials, const std::vector<std::string>& knob_of,
                                   const Tolerances& tolerance, std::size_t most) {
  if (most == 0 || tolerance.empty() || !std::isfinite(score(trials[0], tolerance))) return {};
  return Search(trials, knob_of, tolerance, most).run();
}

std::size_t choose(const std::vector<Trial>& trials, const Tolerances& tolerance) {
  std::size_t best = 0;
  const bool good_as_it_is = meets(trials[0], tolerance);
  for (std::size_t t = 1; t < trials.size(); ++t) {
    if (!meets(trials[t], tolerance) || tolerance.empty()) continue;
    if (trials[t].knobs == 1 && !concerns(trials[t], trials[0], tolerance)) continue;
    // Best times differ by chance from call to call; times that overlap say nothing.
    if (good_as_it_is && trials[t].worst_seconds() >= trials[0].best_seconds()) continue;
    if (!meets(trials[best], tolerance) || trials[t].best_seconds() < trials[best].best_seconds()) best = t;
  }
  return best;
}

}  // namespace grainvdb
