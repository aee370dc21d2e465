/// tests/core/contact/contact_support.h: what the contact tests share: bones ready to be felt in both storages, shells, seeded poses.
///   Frame  as named.   Units  SI; bones have a pitch of 0.5 mm unless said.
#pragma once

#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/contact/gradient_plane.h"
#include "core/tool/make_tool.h"
#include "tests/support/source_folder.h"
#include "volumes/phantom/phantom.h"

namespace burrhole::contact_test {

/// The packed form alone.
inline constexpr ContactFields kWordsOnly{.density = false, .gradient = false, .words = true};

/// A bone with its window published and, when asked for, the paper's grids.
class FeltBone {
 public:
  /// `window` in index coordinates; empty: the whole grid and twelve voxels round it, as a run keeps.
  explicit FeltBone(DenseBone dense, const Pose& world_from_bone = {}, float dead_zone = 0.08f, const VoxelBox& window = {},
                    const ContactFields& fields = {})
      : dense_(std::move(dense)), world_from_bone_(world_from_bone) {
    auto bone = BoneModel::create(dense_);
    REQUIRE(bone.ok());
    auto voxmap = Voxmap::create(std::move(bone).value(), {dead_zone});
    REQUIRE(voxmap.ok());
    voxmap_ = std::make_unique<Voxmap>(std::move(voxmap).value());
    REQUIRE(voxmap_->place_window(window.empty() ? voxmap_->bone().bounds().grown(12) : window).ok());
    publisher_ = std::make_unique<ContactWindowPublisher>(*voxmap_, fields);
    publisher_->publish(*voxmap_);
    window_ = &publisher_->exchange().latest();
  }
  [[nodiscard]] ContactView view() const { return {*window_, dense_.bone_from_index, world_from_bone_}; }
  [[nodiscard]] ContactView vdb_view() {
    if (!grids_) grids_ = std::make_unique<VdbContactGrids>(*voxmap_);
    return {*grids_, dense_.bone_from_index, world_from_bone_};
  }
  [[nodiscard]] const DenseBone& dense() const noexcept { return dense_; }
  [[nodiscard]] const Pose& world_from_bone() const noexcept { return world_from_bone_; }

 private:
  DenseBone dense_;
  Pose world_from_bone_;
  std::unique_ptr<Voxmap> voxmap_;
  std::unique_ptr<ContactWindowPublisher> publisher_;
  std::unique_ptr<VdbContactGrids> grids_;
  const ContactWindow* window_ = nullptr;
};

inline constexpr double kPitch = 0.5e-3;  ///< [m]

/// 12 x 12 x 8 mm at 0.5 mm, 3 mm of air above; the plate is 4 mm thick.
inline PhantomSpec small_spec(PhantomKind kind) {
  PhantomSpec spec;
  spec.kind = kind;
  spec.pitch = kPitch;
  spec.extent = Vec3(0.012, 0.012, 0.008);
  spec.above = 0.003;
  spec.thickness = 0.004;
  spec.sphere_radius = 0.004;
  spec.hole_radius = 0.0025;
  spec.hole_depth = 0.002;
  return spec;
}

inline Phantom phantom_of(const PhantomSpec& spec) {
  auto phantom = make_phantom(spec);
  if (!phantom) FAIL(phantom.error().text());
  return std::move(phantom).value();
}

inline FeltBone felt(const PhantomSpec& spec) { return FeltBone(phantom_of(spec).bone); }

inline PointShell shipped_shell(const std::string& name) {
  Issues issues;
  auto tool = load_tool(test::in_source("app/tools/") + name + ".toml", {.erosion_pitch = 1e-3}, issues);
  REQUIRE(tool);
  return std::move(tool->shell);
}

/// Points of one inward normal.
inline PointShell shell_of(std::vector<Vec3> positions, const Vec3& inward = {0.0, 0.0, 1.0}) {
  PointShell shell;
  shell.inward_normals.assign(positions.size(), inward);
  shell.cutting.assign(positions.size(), 1);
  shell.positions = std::move(positions);
  return shell;
}

inline std::unique_ptr<PenaltyModel> model_of(const PointShell& shell, const GradientPlaneConfig& config = {}) {
  auto model = GradientPlane::create(config, shell);
  REQUIRE(model.ok());
  return std::move(model).value();
}

inline ContactResult evaluated(const PenaltyModel& model, const ContactView& bone, const Pose& world_from_tool = {}) {
  ContactResult out;
  model.evaluate(bone, world_from_tool, out);
  return out;
}

inline Vec3 random_vector(std::uint64_t seed, std::uint64_t n) {
  return {uniform11(seed, 3 * n), uniform11(seed, 3 * n + 1), uniform11(seed, 3 * n + 2)};
}

/// Any rotation: four numbers of a ball-shaped neighbourhood would be even; a cube's are even enough for poses.
inline Quat random_rotation(std::uint64_t seed, std::uint64_t n) {
  const Quat q(uniform11(seed, 4 * n), uniform11(seed, 4 * n + 1), uniform11(seed, 4 * n + 2), uniform11(seed, 4 * n + 3) + 1.5);
  return glm::normalize(q);
}

inline Quat turn_about_x(double radians) { return glm::angleAxis(radians, Vec3(1.0, 0.0, 0.0)); }

}  // namespace burrhole::contact_test
