/// tests/core/contact/shipped_bone.h: bone as a run keeps it for contact: voxmap, published window, records; may be drilled.
///   Frame  as named.   Units  SI.
#pragma once

#include "contact_support.h"
#include "core/contact/constrained_tool.h"
#include "core/contact/surface_view.h"
#include "core/drill/erosion.h"
#include "tests/support/plain_trilinear.h"

namespace burrhole::contact_test {

class ShippedBone {
 public:
  /// The window is the whole grid and `margin` voxels round it; records are known to within seven voxels of the window's edge.
  explicit ShippedBone(const DenseBone& dense, const Pose& world_from_bone = {}, RecordPrecision precision = RecordPrecision::bits16,
                       int margin = 19, const LabelFactors& label_stiffness = kAllAlike)
      : map_(dense.bone_from_index), world_from_bone_(world_from_bone) {
    auto bone = BoneModel::create(dense);
    REQUIRE(bone.ok());
    auto voxmap = Voxmap::create(std::move(bone).value(), {});
    REQUIRE(voxmap.ok());
    voxmap_ = std::make_unique<Voxmap>(std::move(voxmap).value());
    REQUIRE(voxmap_->place_window(voxmap_->bone().bounds().grown(margin)).ok());
    publisher_ = std::make_unique<ContactWindowPublisher>(
        *voxmap_, ContactFields{.density = true, .gradient = false, .records = precision, .label_stiffness = label_stiffness});
    publish();
  }
  explicit ShippedBone(const Phantom& phantom, const Pose& world_from_bone = {}, RecordPrecision precision = RecordPrecision::bits16)
      : ShippedBone(phantom.bone, world_from_bone, precision) {}

  [[nodiscard]] SurfaceView view() const {
    const auto out = surface_view(*window_, map_, world_from_bone_);
    REQUIRE(out.has_value());
    return *out;
  }
  void move_bone(const Pose& world_from_bone) noexcept { world_from_bone_ = world_from_bone; }

  /// One simulation step of the tool's erosion on the way between two poses, published.
  ErosionOutcome drill(Erosion& erosion, const Pose& from, const Pose& to, double spin, double dt) {
    const Affine index_from_world = map_.inverse() * Affine::from_pose(world_from_bone_.inverse());
    const ErosionOutcome out =
        erosion.step(*voxmap_, {index_from_world * Affine::from_pose(from), index_from_world * Affine::from_pose(to)}, spin, dt);
    voxmap_->commit(out.changed);
    publish();
    return out;
  }

  [[nodiscard]] double edge() const { return map_.mean_edge(); }
  [[nodiscard]] const Voxmap& voxmap() const noexcept { return *voxmap_; }

  /// Trilinear density at a point of the bone frame, in double, straight from the master window: the plain truth about what is felt.
  [[nodiscard]] double density(const Vec3& p_bone) const {
    const MasterWindow& w = voxmap_->window();
    return test::plain_trilinear(map_.inverse() * p_bone,
                                 [&](const Vec3i& v) { return w.box.contains(v) ? w.density[w.box.offset_of(v)] : 0.0f; });
  }

 private:
  void publish() {
    publisher_->publish(*voxmap_);
    window_ = &publisher_->exchange().latest();
  }

  Affine map_;
  Pose world_from_bone_;
  std::unique_ptr<Voxmap> voxmap_;
  std::unique_ptr<ContactWindowPublisher> publisher_;
  const ContactWindow* window_ = nullptr;
};

/// A round shell with its origin in its middle, dense enough to be a ball: gaps between points stand back from it by pitch^2 / (4 radius).
inline PointShell ball_shell(double radius, std::size_t count, const Vec3& centre = Vec3(0.0)) {
  PointShell shell;
  const double golden = 2.399963229728653;  // turn between points of an even spiral
  for (std::size_t n = 0; n < count; ++n) {
    const double z = 1.0 - (2.0 * static_cast<double>(n) + 1.0) / static_cast<double>(count), r = std::sqrt(1.0 - z * z);
    const double turn = golden * static_cast<double>(n);
    const Vec3 out(r * std::cos(turn), r * std::sin(turn), z);
    shell.positions.push_back(centre + radius * out);
    shell.inward_normals.push_back(-out);
    shell.cutting.push_back(1);
  }
  return shell;
}

inline double degrees_between(const Vec3& a, const Vec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / kDegree; }

}  // namespace burrhole::contact_test
