#pragma once
/// Results that are no fields: rows of numbers with units, and single numbers with their errors.
#include <limits>
#include <string>
#include <vector>

#include "grainvdb/units.hpp"

namespace grainvdb {

/// One value per row; NaN where there is none.
struct TableColumn {
  std::string name;  ///< letters, digits and underscores, as in what follows: programs take it for a variable's name
  Dimension dimension{};
  std::string description;  ///< one line
  std::vector<double> values{};
  std::string unit{};  ///< of the dimension, in the run's unit system; the run fills it in
};

/// A single number that was measured.
struct Quantity {
  std::string name;
  double value = 0;
  double error = std::numeric_limits<double>::quiet_NaN();  ///< standard error; NaN where it has none
  Dimension dimension{};
  std::string description;  ///< one line
  std::string unit{};       ///< as of a column
};

/// What a measurement comes to.
struct Table {
  std::string name;                    ///< letters, digits and underscores; unique within a run
  std::string description;             ///< one line
  std::string equation;                ///< with its tag
  std::vector<TableColumn> columns{};  ///< of equal length; the first is what the others are drawn against
  std::vector<Quantity> numbers{};
  std::vector<std::string> remarks{};  ///< sentences: what was refused, and why
};

}  // namespace grainvdb
