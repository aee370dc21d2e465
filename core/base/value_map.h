/// core/base/value_map.h: a section through a field of values, for a report.
///   Units  as the labels say.   Thread  any.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace burrhole {

struct ValueMap {
  std::string title, caption;
  std::string x_label, y_label, unit;  ///< labels include the unit of the axis; `unit` is that of the values, with their name
  double x = 0.0, y = 0.0;             ///< [unit of the axes] centre of the first value
  double pitch = 1.0;                  ///< [unit of the axes] between values, both ways; y increases downwards
  std::size_t columns = 0, rows = 0;
  std::vector<float> values;  ///< [unit] row by row, columns x rows; NaN: nothing is drawn
};

}  // namespace burrhole
