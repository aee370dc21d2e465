/// core/tool/join_rounded.h: closes the gaps that rounding leaves between the triangles of a mesh file.
///   Frame  of the file.   Units  m.   Errors  none.
#pragma once

#include <cstddef>
#include <string>

#include "core/tool/surface_mesh.h"

namespace burrhole {

/// Vertices that join_rounded() has joined with others.
struct RoundingJoin {
  std::size_t joined = 0;
  double tolerance = 0.0;  ///< [m]
  /// @returns one sentence.
  [[nodiscard]] std::string text() const;
};

/// A vertex of an open edge takes the position of an earlier such vertex within the tolerance. It is four roundings of a 32-bit float at
/// the largest coordinate, 2^-22 of that: 24 nm at 100 mm. Each vertex is moved by at most the tolerance, and a mesh without open edges
/// stays as it is. @pre as weld().
RoundingJoin join_rounded(SurfaceMesh& mesh);

}  // namespace burrhole
