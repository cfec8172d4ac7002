#pragma once
/// Which of the measured settings to prefer, and which combinations of them are worth a try.
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "grainvdb/tune.hpp"

namespace grainvdb {

using Tolerances = std::map<std::string, double>;

/// Of each trial: no other takes no longer and scores no worse, one of them being better. Refused trials never are.
std::vector<bool> pareto_front(const std::vector<Trial>& trials, const Tolerances& tolerance);

/// Whether a trial was run and keeps to every tolerance.
bool meets(const Trial& trial, const Tolerances& tolerance);

/// A combination of values of different knobs, by the numbers of the trials that set each by itself.
struct Combination {
  std::vector<std::size_t> trials;
  double seconds = 0;  ///< predicted
};

/// The `most` fastest combinations of two values and more that are predicted to keep to the tolerances. Times
/// multiply: each value's ratio to the current setting (trial 0). Errors add up in squares: what a value adds to, or
/// takes off, the current square. A value that changes the error of no field with a tolerance by more than 1 % takes no
/// part: the tolerances say nothing about what it does change.
std::vector<Combination> promising(const std::vector<Trial>& trials, const std::vector<std::string>& knob_of,
                                   const Tolerances& tolerance, std::size_t most);

/// The fastest trial that meets the tolerances and sets only what they say something about. Where the current one (0)
/// meets them too, it stays unless every repeat of the other took less time than its fastest; so it does where there is
/// none.
std::size_t choose(const std::vector<Trial>& trials, const Tolerances& tolerance);

}  // namespace grainvdb
