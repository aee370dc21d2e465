#include "app/bench/contact_bones.h"

#include <fmt/format.h>

#include "core/base/random.h"
#include "core/contact/surface_view.h"
#include "core/tool/point_shell.h"
#include "volumes/phantom/phantom.h"

namespace burrhole {
namespace {

constexpr double kBallRadius = 1.5e-3;  // [m]

Result<BoneForms> make_bone(const DenseBone& dense) {
  auto bone = BoneModel::create(dense);
  if (!bone) return bone.error();
  auto voxmap = Voxmap::create(std::move(bone).value(), {});
  if (!voxmap) return voxmap.error();
  if (Status placed = voxmap->place_window(voxmap->bone().bounds().grown(2)); !placed) return placed.error();
  return BoneForms(std::move(voxmap).value());
}

Result<BoneForms> make_bone(const PhantomSpec& spec) {
  const auto phantom = make_phantom(spec);
  if (!phantom) return phantom.error();
  return make_bone(phantom->bone);
}

void append(std::vector<double>& out, const Vec3& v) { out.insert(out.end(), {v.x, v.y, v.z}); }

}  // namespace

BoneForms::BoneForms(Voxmap placed) : voxmap(std::make_unique<Voxmap>(std::move(placed))) {
  floats = std::make_unique<ContactWindowPublisher>(*voxmap);
  words = std::make_unique<ContactWindowPublisher>(*voxmap, ContactFields{.density = false, .gradient = false, .words = true});
  const auto with_records = [&](RecordPrecision precision) {
    return std::make_unique<ContactWindowPublisher>(
        *voxmap, ContactFields{.density = false, .gradient = false, .words = false, .records = precision});
  };
  records8 = with_records(RecordPrecision::bits8);
  records16 = with_records(RecordPrecision::bits16);
  for (const auto* publisher : {&floats, &words, &records8, &records16}) (*publisher)->publish(*voxmap);
  grids = std::make_unique<VdbContactGrids>(*voxmap);
}

ContactView BoneForms::float_view(const Pose& world_from_bone) const {
  return {floats->exchange().latest(), voxmap->bone().bone_from_index(), world_from_bone};
}
ContactView BoneForms::word_view(const Pose& world_from_bone) const {
  return {words->exchange().latest(), voxmap->bone().bone_from_index(), world_from_bone};
}
ContactView BoneForms::grid_view(const Pose& world_from_bone) const { return {*grids, voxmap->bone().bone_from_index(), world_from_bone}; }

SurfaceView BoneForms::surface_view(RecordPrecision precision, const Pose& world_from_bone) const {
  ContactWindowPublisher& publisher = precision == RecordPrecision::bits8 ? *records8 : *records16;
  return *burrhole::surface_view(publisher.exchange().latest(), voxmap->bone().bone_from_index(), world_from_bone);
}

Result<BoneForms> make_ball_of_bone() {
  PhantomSpec spec;
  spec.kind = PhantomKind::sphere;
  spec.pitch = kBenchEdge;
  spec.extent = Vec3(8e-3);
  spec.sphere_radius = 2.25e-3;
  return make_bone(spec);
}

Result<BoneForms> make_thick_plate() {
  PhantomSpec spec;
  spec.kind = PhantomKind::plate;
  spec.pitch = kBenchEdge;
  spec.extent = Vec3(16e-3, 16e-3, 14e-3);
  spec.thickness = 9e-3;
  spec.plate_normal = Vec3(0.1, 0.07, 1.0);
  return make_bone(spec);
}

Result<BoneForms> make_socket() {
  DenseBone dense;
  dense.dims = Vec3i(48);
  dense.bone_from_index = Affine::scaling(kBenchEdge, Vec3(-23.5 * kBenchEdge));
  for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
    const double outside = glm::length(dense.bone_from_index * Vec3(v)) / kBenchEdge - (kBallRadius / kBenchEdge + 0.1);
    dense.occupancy.push_back(static_cast<float>(std::clamp(0.5 + outside, 0.0, 1.0)));
  });
  dense.hardness.assign(dense.occupancy.size(), 1.0f);
  dense.labels.assign(dense.occupancy.size(), static_cast<std::uint8_t>(VoxelLabel::bone));
  return make_bone(dense);
}

Result<PointShell> make_ball(int stacks, int slices, std::size_t points) {
  Issues issues;
  const std::string text = fmt::format(
      "title = \"Ball\"\n[[region]]\nname = \"bit\"\nshape = \"sphere\"\nz_mm = 0\ndiameter_mm = 3\n"
      "stacks = {}\nslices = {}\nerosion_factor = 0.1\n",
      stacks, slices);
  const auto document = TomlDocument::parse(text, "ball.toml");
  if (!document) return document.error();
  const auto spec = read_tool_spec(document.value(), issues);
  if (!spec) return issues.front();
  auto shell = make_point_shell(*spec);
  if (!shell) return shell;
  if (shell->size() < points || shell->size() > points + 2)
    return Error{ErrorCode::internal, fmt::format("a ball of {} stacks has {} points, not {}", stacks, shell->size(), points), {}};
  shell->positions.resize(points);
  shell->inward_normals.resize(points);
  shell->cutting.resize(points);
  for (Vec3& p : shell->positions) p.z -= kBallRadius;
  PointShell sorted;
  for (const std::uint32_t n : morton_order(shell->positions)) {
    sorted.positions.push_back(shell->positions[n]);
    sorted.inward_normals.push_back(shell->inward_normals[n]);
    sorted.cutting.push_back(shell->cutting[n]);
  }
  return sorted;
}

std::vector<Pose> poses_in_ball() {
  std::vector<Pose> out;
  for (std::uint64_t n = 0; n < 16; ++n) {
    const auto random = [n](std::uint64_t k) { return uniform11(21, 16 * n + k); };
    const Vec3 shift = Vec3(random(0), random(1), random(2)) * (0.69 * kBenchEdge);
    const Quat turn = glm::normalize(Quat(random(3), random(4), random(5), random(6)));
    out.push_back({turn, Vec3(0.0, 0.0, -2.25e-3) + shift});
  }
  return out;
}

ContactSamples evaluate_poses(const PenaltyModel& model, const ContactView& bone, const std::vector<Pose>& poses) {
  ContactSamples out;
  ContactResult result;
  for (const Pose& pose : poses) {
    model.evaluate(bone, pose, result);
    out.forces.push_back(result.wrench.force);
    append(out.numbers, result.wrench.force);
    append(out.numbers, result.wrench.torque);
    for (const Contact& contact : result.contacts) {
      append(out.numbers, contact.plane_point);
      append(out.numbers, contact.normal);
      out.numbers.push_back(contact.depth);
    }
    out.contacts += result.contacts.size();
  }
  return out;
}

double force_difference(const ContactSamples& a, const ContactSamples& b) {
  double most = 0.0, difference = 0.0;
  for (std::size_t n = 0; n < a.forces.size(); ++n) {
    most = std::max(most, glm::length(a.forces[n]));
    difference = std::max(difference, glm::length(a.forces[n] - b.forces[n]));
  }
  return difference / most;
}

Side evaluate_all(const PenaltyModel& model, const ContactView& bone, const std::vector<Pose>& poses, ContactResult& scratch) {
  scratch.list_contacts = false;  // as in a tick of this model
  return {.prepare = {}, .run = [&] {
            for (const Pose& pose : poses) model.evaluate(bone, pose, scratch);
          }};
}

}  // namespace burrhole
