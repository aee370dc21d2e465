#include "app/lab/contact_rig.h"

namespace burrhole {

Result<ContactRig> ContactRig::create(const PhantomSpec& spec) {
  auto phantom = make_phantom(spec);
  if (!phantom) return phantom.error();
  auto bone = BoneModel::create(phantom->bone);
  if (!bone) return bone.error();
  auto voxmap = Voxmap::create(std::move(bone).value(), {});
  if (!voxmap) return voxmap.error();
  ContactRig rig;
  rig.truth_ = std::make_unique<Truth>(phantom->truth);
  rig.bone_from_index_ = phantom->bone.bone_from_index;
  rig.voxmap_ = std::make_unique<Voxmap>(std::move(voxmap).value());
  // Ten voxels of air round it: a gradient needs two, a record seven, and a bit may stand out a little.
  if (const Status placed = rig.voxmap_->place_window(rig.voxmap_->bone().bounds().grown(10)); !placed) return placed.error();
  rig.publisher_ = std::make_unique<ContactWindowPublisher>(*rig.voxmap_, ContactFields{.records = RecordPrecision::bits16});
  rig.publisher_->publish(*rig.voxmap_);
  rig.grids_ = std::make_unique<VdbContactGrids>(*rig.voxmap_);
  return rig;
}

SurfaceView ContactRig::surface_view() const {
  const ContactWindow& copy = publisher_->exchange().latest();
  return {{copy.box, copy.records_valid, nullptr, std::get<std::vector<Record16>>(copy.records).data(), bone_from_index_},
          copy.hardness.data(),
          Pose{}};
}

double ContactRig::window_bytes() const { return static_cast<double>(voxmap_->window().box.count() * (sizeof(float) + sizeof(Vec3f))); }

}  // namespace burrhole
