/// tests/core/contact/paper_twin.h: [AcostaLiu07] section 2 once more, slow and plain, written from its text; shares no code with core.
///   Frame  world for what goes in and out.   Units  SI.   Bone is a map from voxel to density; gradients are taken when asked for.
#pragma once

#include <array>
#include <map>
#include <vector>

namespace burrhole::contact_test {

using Triple = std::array<double, 3>;
using Cell = std::array<int, 3>;
using Rows = std::array<Triple, 3>;  ///< matrix, row by row

struct TwinBone {
  std::map<Cell, double> density;  ///< 0 where absent
  Rows linear;                     ///< world = linear * index + offset
  Triple offset;
  double dead_zone = 0.08;
};

struct TwinPoint {
  Triple position;     ///< P_h, world
  Triple tool_vector;  ///< world, unit
};

struct TwinLaw {
  double stiffness = 2000.0;
  bool any_density_collides = false;  ///< the paper's; otherwise the 0.5 surface
  int longest_march = 64, longest_ascent = 64;
};

struct TwinAnswer {
  Triple force{}, torque{};
  std::vector<double> depths;  ///< of the colliding points that found a surface, in order
  int lost = 0;                ///< points whose walk met a limit
  int without_gradient = 0;
};

/// Torque about `origin`.
TwinAnswer twin_force(const TwinBone& bone, const TwinLaw& law, const std::vector<TwinPoint>& points, const Triple& origin);

}  // namespace burrhole::contact_test
