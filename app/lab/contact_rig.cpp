#include "app/lab/contact_rig.h"

#include "core/contact/contact_form.h"
#include "core/mesh/mesh_form.h"

namespace burrhole {
namespace {

/// What a run publishes for a model with its default keys.
ContactFields shipped_fields(std::unique_ptr<ContactForm> (*read)(TableReader&)) {
  Issues issues;
  const auto document = TomlDocument::parse("", "defaults");
  BH_ASSERT(document.ok());
  TableReader table = document->root(issues);
  return read(table)->needs().fields;
}

}  // namespace

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
  // A margin of ten voxels of air: a gradient needs two, a record seven, and a bit may extend beyond the phantom.
  if (const Status placed = rig.voxmap_->place_window(rig.voxmap_->bone().bounds().grown(10)); !placed) return placed.error();
  const auto publish = [&](const ContactFields& fields) {
    auto publisher = std::make_unique<ContactWindowPublisher>(*rig.voxmap_, fields);
    publisher->publish(*rig.voxmap_);
    return publisher;
  };
  rig.words_ = publish(shipped_fields(read_gradient_plane_form));
  rig.floats_ = publish({.density = true, .gradient = true});
  rig.mesh_ = publish(shipped_fields(read_mesh_form));
  rig.records_ = publish(shipped_fields(read_surface_form));
  rig.grids_ = std::make_unique<VdbContactGrids>(*rig.voxmap_);
  return rig;
}

SurfaceView ContactRig::surface_view() const {
  const auto view = burrhole::surface_view(records_->exchange().latest(), bone_from_index_, Pose{});
  BH_ASSERT(view.has_value());
  return *view;
}

double ContactRig::mesh_bytes() const { return static_cast<double>(mesh_->exchange().latest().bytes()); }

double ContactRig::bytes_of(const ContactWindowPublisher& publisher) const {
  return static_cast<double>(voxmap_->window().box.count() * bytes_a_voxel(publisher.fields()));
}

}  // namespace burrhole
