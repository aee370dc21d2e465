/// volumes/read/layer_profile.h: borders of the layers of a skull in a blurred profile of values across it.
///   Frame  depth along the inward normal, 0 at the outer surface of the bone.   Units  SI; values in the unit of the scan.
///   Errors none: a profile without layers has is_layered false.   Thread any.
///   Source own derivation. The profile is taken as five constant pieces (outside, outer table, diploe, inner table, inside) under a Gaussian
///          blur. Seven features are measured on it: both peaks, the least value between them, and the four depths at which the value is half
///          way between its neighbours. Blur shifts these features. So the same features are measured on the blurred model, and the
///          parameters of the model are changed by the differences until both agree.
#pragma once

#include <vector>

namespace burrhole {

/// Values at equal steps of depth.
struct LayerProfile {
  double start = 0.0;         ///< [m] depth of the first value
  double step = 0.0;          ///< [m]
  std::vector<float> values;  ///< [unit of the scan's values]

  [[nodiscard]] double depth_of(double index) const noexcept { return start + index * step; }
  [[nodiscard]] double at(double depth) const noexcept;  ///< linear; the first or last value beyond the ends
};

struct LayerLimits {
  double thickness = 0.0;       ///< [m] of the bone: depth of its inner surface
  double least_dip = 0.1;       ///< [-] of diploe below the lesser peak, over the height of that peak above its surroundings
  double least_table = 0.5e-3;  ///< [m]
  double most_value = 1e9;      ///< [unit of the scan] of a table
  double blur = 0.0;            ///< [m] standard deviation; 0: from the slope of the outer edge
  double outside_depth = 2e-3;  ///< [m] beyond the surfaces: there the value is that of the surroundings
};

struct LayerBorders {
  bool is_layered = false;
  double dip = 0.0;                              ///< [-] as LayerLimits::least_dip
  double blur = 0.0;                             ///< [m] that was assumed
  double outer_edge = 0.0, inner_edge = 0.0;     ///< [m] depths of the edges of the bone, half way between values
  double outer = 0.0, inner = 0.0;               ///< [m] depths of the borders between the tables and diploe, outer <= inner
  double table_value = 0.0, diploe_value = 0.0;  ///< [unit of the scan] larger of the tables; diploe, after removal of the blur
};

[[nodiscard]] LayerBorders find_layers(const LayerProfile& profile, const LayerLimits& limits);

}  // namespace burrhole
