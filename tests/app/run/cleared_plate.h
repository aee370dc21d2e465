/// tests/app/run/cleared_plate.h: a plate with holes made by hand, for what measures holes and watches tips.
#pragma once

#include <doctest/doctest.h>

#include <memory>

#include "core/measure/approach.h"
#include "core/voxel/voxmap.h"
#include "volumes/phantom/phantom.h"

namespace burrhole::test {

/// A plate of 10 x 10 x 3 mm at 0.25 mm, its outer face at the origin, and its way in along -z.
struct ClearedPlate {
  static constexpr double kThickness = 3e-3, kPitch = 0.25e-3;  // [m]
  std::shared_ptr<const BoneModel> bone;
  std::unique_ptr<Voxmap> voxmap;
  Approach approach;

  ClearedPlate() {
    PhantomSpec spec;
    spec.kind = PhantomKind::plate;
    spec.thickness = kThickness;
    spec.pitch = kPitch;
    spec.extent = Vec3(10e-3, 10e-3, 6e-3);
    spec.above = 1.5e-3;
    const auto phantom = make_phantom(spec);
    REQUIRE(phantom);
    auto model = BoneModel::create(phantom->bone);
    REQUIRE(model);
    bone = *model;
    auto made = Voxmap::create(bone, {});
    REQUIRE(made);
    voxmap = std::make_unique<Voxmap>(std::move(*made));
    REQUIRE(voxmap->place_window(bone->bounds().grown(3)));
    auto planned = make_approach(*bone, {});
    REQUIRE(planned);
    approach = std::move(*planned);
  }

  /// Takes away bone above `depth` [m] and within `radius` [m] of the z axis; the edge ramps over a voxel, so that its 0.5 level is true
  /// where depths are whole voxels.
  void clear(double radius, double depth) {
    const MasterWindow& window = voxmap->window();
    const VoxelBox box = window.erodible_box();
    for_each_voxel(box, [&](const Vec3i& v) {
      const Vec3 p = bone->bone_from_index() * Vec3(v);
      const double outside = std::max(std::sqrt(p.x * p.x + p.y * p.y) - radius, -depth - p.z) / kPitch;
      float& left = voxmap->remaining()[window.box.offset_of(v)];
      left = std::min(left, static_cast<float>(std::clamp(0.5 + outside, 0.0, 1.0)));
    });
    voxmap->commit(box);
  }
};

}  // namespace burrhole::test
