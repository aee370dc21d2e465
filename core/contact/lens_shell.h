/// core/contact/lens_shell.h: the cutting points of a tool that is engaged in bone which recedes from its face (core/drill/cut_face.h).
///   Frame  tool frame.   Units  SI.   Thread  built once, used by contact. Never allocates after construction.
///   Source own derivation. Bone is tested at the proxy pose, the tool's pose moved by the engagement e out of bone. The tool itself has
///   been where proxy and tool overlap, and has cut there. A point of the proxy outside the tool may lie in bone that the tool never
///   reaches: a ball of radius R leaves a hole that is narrower by e^2 / (8 R). Such a point q = p + e with D(q) > -c, D the signed
///   distance to the tool, is moved onto the face D = -c: p - (D(q) + c) grad D(q). Points on the leading face are far inside the tool and
///   stay. The clearance c keeps the sides of a bit off the wall of its own hole.
///   Edges are rounded (rounded_edges.h), in proportion to the engagement up to the clearance.
#pragma once

#include <memory>
#include <vector>

#include "core/contact/contact_shell.h"
#include "core/tool/cutting_field.h"
#include "core/tool/field_kernels.h"

namespace burrhole {

class LensShell {
 public:
  /// Without a field the points are never moved.
  LensShell(const PointShell& shell, std::shared_ptr<const CuttingField> field, double voxel_edge);

  [[nodiscard]] bool active() const noexcept { return field_ != nullptr; }
  /// Computes the positions for an engagement [m], a vector out of bone.
  void engage(const Vec3& engagement) noexcept;
  /// Writes the positions into a part of the shell, relative to `middle` [m], with padding.
  void draw(const Vec3& middle, ContactShellPart& part) const noexcept;
  /// @returns the position of a point of the shell.
  [[nodiscard]] const Vec3& at(std::size_t point) const noexcept { return position_[point]; }
  /// @returns whether the point is on a smooth face, so that the contact normal is that of the tool.
  [[nodiscard]] bool smooth(std::size_t point) const noexcept { return edges_[point] == Vec3(0.0); }

 private:
  std::shared_ptr<const CuttingField> field_;
  FieldJob job_{};
  double edge_;                            // [m] of a voxel
  std::vector<Vec3> original_, position_;  // [m] of all points of the shell
  std::vector<Vec3> edges_;                // [m] displacements that round the edges
  std::vector<std::uint32_t> cutting_;     // points that cut
  std::vector<std::uint32_t> moved_;       // scratch
  std::vector<float> x_, y_, z_, distance_;
};

}  // namespace burrhole
