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
  // Two voxels of air round it: the gradient of the outermost layer needs one, and contact knows nothing of the window's own outermost.
  if (const Status placed = rig.voxmap_->place_window(rig.voxmap_->bone().bounds().grown(2)); !placed) return placed.error();
  rig.publisher_ = std::make_unique<ContactWindowPublisher>(*rig.voxmap_);
  rig.publisher_->publish(*rig.voxmap_);
  rig.grids_ = std::make_unique<VdbContactGrids>(*rig.voxmap_);
  return rig;
}

double ContactRig::window_bytes() const { return static_cast<double>(voxmap_->window().box.count() * (sizeof(float) + sizeof(Vec3f))); }

}  // namespace burrhole
