/// app/effect/dura_picture.h: the sheet of [dura] as pictures show it: a smooth shell with the thickness of dura, open where it is torn, and the
/// brain below it.
///   The dura and brain of the bone as loaded are shown below the shell alone: the sheet replaces their upper face within its radius.
///   Frame  bone frame.   Units  m.   Errors  none.   Thread  as PictureSource.
#pragma once

#include <optional>
#include <vector>

#include "app/effect/dura_rent.h"
#include "app/view/added_mesh.h"
#include "core/sheet/elastic_sheet.h"

namespace burrhole {

class DuraPicture final : public PictureSource, public SoftTop {
 public:
  /// @param sheet must outlive this. @param thickness [m] of the dura. @param edge [m] of a voxel.
  DuraPicture(const ElasticSheet& sheet, const Pose& bone_from_sheet, double thickness, double edge);

  [[nodiscard]] bool copy_for_picture(bool exactly) override;
  void append_mesh(AddedMesh& out) const override;
  [[nodiscard]] const SoftTop* soft_top() const override { return this; }
  [[nodiscard]] double shown(const Vec3& p_bone, double edge) const override;
  [[nodiscard]] Bounds changed() const override { return changed_; }
  [[nodiscard]] Bounds extent() const override { return extent_; }

 private:
  void find_shape();
  void lower_soft(const std::vector<double>& wanted, double seen);

  const ElasticSheet* sheet_;
  Pose bone_from_sheet_, sheet_from_bone_;
  double thickness_, edge_;
  std::vector<Vec3> x_;                // [m] of the last copy, sheet frame
  std::vector<Vec3> shape_, normals_;  // [m], [-] as drawn: x_ without the nodes that a rent has cut out
  std::vector<std::uint8_t> broken_;   // edges of the last copy
  std::optional<DuraRent> rent_;       // of those edges
  std::vector<double> top_;            // [m] z below which soft tissue is shown at each node
  bool exact_ = false;                 // so was the last copy
  Bounds changed_ = Bounds::none(), extent_ = Bounds::none();
};

}  // namespace burrhole
