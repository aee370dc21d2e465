/// app/view/cut_mesh.h: a mesh cut open by a plane, with its section closed, for pictures of a bit in section.
///   Frame  that of the mesh.   Units  SI.   Errors  none.   Thread  any.   Source  own derivation, shown in cut_mesh.cpp.
#pragma once

#include <functional>
#include <vector>

#include "core/tool/tool.h"

namespace burrhole {

/// Lengths of the normals of a section whose parts are known; those of a surface have length 1. shaders/tool.frag draws the parts apart.
inline constexpr double kSectionCuts = 2.0, kSectionBody = 3.0;

/// The parts of a bit that a section shows.
struct SectionParts {
  std::vector<double> heights;            ///< [m] along z, at which parts may begin or end
  std::function<bool(const Vec3&)> cuts;  ///< whether the material at a point [m] cuts
};

/// Removes the side dot(normal, p) > offset of closed surfaces, counter-clockwise seen from outside, which may overlap. The section is filled
/// where any of them has material. @param normal of length 1. @param parts of the bit: if given, the section is split where
/// they meet, and its normals have the lengths above. @returns a mesh without triangles if nothing is left.
[[nodiscard]] TriangleMesh cut_mesh(const TriangleMesh& mesh, const Vec3& normal, double offset, const SectionParts* parts = nullptr);

}  // namespace burrhole
