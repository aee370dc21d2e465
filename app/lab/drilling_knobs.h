/// app/lab/drilling_knobs.h: the settings that `burrhole cost drilling` varies one at a time, each as multiples of the value that a scene or
///   tool takes when it says nothing.
///   Units  those of the keys.   Errors  none.   Thread  any.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/lab/drilling_trial.h"

namespace burrhole {

struct DrillingKnob {
  std::string name;                                           ///< "table.key", as in the file
  std::string unit;                                           ///< of the key
  std::string note;                                           ///< on the reference run, beside its value; may be empty
  std::vector<double> multiples;                              ///< [-] of the default; contains 1
  std::vector<double> quick;                                  ///< [-] those of the short study; contains 1
  double finest = 1.0;                                        ///< [-] multiple of the reference run
  double quick_finest = 1.0;                                  ///< [-] the same of the short study
  double (*shipped)(const LoadedScene&);                      ///< [unit of the key] the default
  void (*set)(double value, double shipped, DrillingTrial&);  ///< adds the assignments of a value [unit of the key]
};

[[nodiscard]] const std::vector<DrillingKnob>& drilling_knobs();
/// @returns the value [unit of the key] of the reference run of a bit: the finest, as far as the bit fits into the window of bone.
[[nodiscard]] double finest_value(const DrillingKnob& knob, const DrillingBit& bit, bool quick, double shipped);
/// @returns the value of the second level of the reference, half as fine as the first: for a figure that converges with the first order, the
/// difference of the two is the error of the first. Nothing where the reference is no limit but the setting itself: no latency, all bits.
[[nodiscard]] std::optional<double> second_value(const DrillingKnob& knob, const DrillingBit& bit, bool quick, double shipped);

}  // namespace burrhole
