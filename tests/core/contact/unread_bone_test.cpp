// What every model does where the window is not: free far from bone, held where bone may be and has not been read.

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contact_support.h"
#include "core/contact/coupled_contact.h"
#include "core/contact/gradient_plane.h"
#include "core/contact/penalty_contact.h"
#include "core/contact/surface_contact.h"
#include "shipped_bone.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr double kTick = 1e-3, kEdge = 0.5e-3;

/// A plate of 40 x 40 x 4 mm under 20 mm of air, of which only a window has been read.
class PartlyRead {
 public:
  PartlyRead() {
    PhantomSpec spec = small_spec(PhantomKind::plate);
    spec.extent = Vec3(0.040, 0.040, 0.028);
    spec.above = 0.020;
    const DenseBone dense = phantom_of(spec).bone;
    map_ = dense.bone_from_index;
    auto bone = BoneModel::create(dense);
    REQUIRE(bone.ok());
    coarse_.emplace(**bone);
    auto voxmap = Voxmap::create(std::move(bone).value(), {});
    REQUIRE(voxmap.ok());
    voxmap_ = std::make_unique<Voxmap>(std::move(voxmap).value());
    REQUIRE(voxmap_->place_window(kCorner).ok());
    publisher_ = std::make_unique<ContactWindowPublisher>(
        *voxmap_, ContactFields{.density = true, .gradient = true, .records = RecordPrecision::bits16});
    publisher_->publish(*voxmap_);
  }
  void read_all() { read(voxmap_->bone().bounds().grown(12)); }
  void read_corner() { read(kCorner); }
  BoneView view() {
    const ContactWindow& window = publisher_->exchange().latest();
    return {ContactView(window, map_, {}), surface_view(window, map_, {}, &*coarse_), {}, &*coarse_};
  }

 private:
  void read(const VoxelBox& box) {
    REQUIRE(voxmap_->place_window(box).ok());
    publisher_->publish(*voxmap_);
  }
  static constexpr VoxelBox kCorner{Vec3i(0), Vec3i(20)};
  Affine map_;
  std::optional<CoarseDistance> coarse_;
  std::unique_ptr<Voxmap> voxmap_;
  std::unique_ptr<ContactWindowPublisher> publisher_;
};

struct Model {
  std::string name;
  std::unique_ptr<ContactModel> model;
  double spring;       // [N/m] that holds the hand
  bool where_hand_is;  // the tool's pose is the hand's
};

std::vector<Model> every_model() {
  const PointShell ball = ball_shell(2e-3, 600, Vec3(0.0, 0.0, 2e-3));
  const ContactOptions options{.voxel_edge = kEdge, .planes = true, .foresight = 2.0 * kTick};
  const auto planes = [&] { return GradientPlane::create(GradientPlaneConfig{}, ball); };
  std::vector<Model> out;
  out.push_back({"surface", std::move(make_surface_contact(ConstrainedToolConfig{}, ball, options)).value(),
                 ConstrainedToolConfig{}.coupling_stiffness, false});
  out.push_back({"gradient-plane", std::move(make_penalty_contact(planes(), options)).value(), GradientPlaneConfig{}.stiffness, true});
  out.push_back({"gradient-plane on a spring", std::move(make_coupled_contact(VirtualCouplingConfig{}, planes(), options)).value(),
                 VirtualCouplingConfig{}.stiffness, false});
  return out;
}

}  // namespace

TEST_CASE("unread bone: every model is free far from it, is held before it, and touches it once it is read") {
  for (Model& m : every_model()) {
    CAPTURE(m.name);
    PartlyRead bone;
    ContactState state;
    constexpr double kStart = 15e-3, kEnd = -2e-3, kSpeed = 0.1;
    const auto height = [&](int tick) { return std::max(kEnd, kStart - kSpeed * kTick * tick); };
    const auto step = [&](int tick) {
      const double z = height(tick);
      const HandMotion hand{{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, z)}, Vec3(0.0, 0.0, z > kEnd ? -kSpeed : 0.0)};
      const BoneView view = bone.view();
      m.model->step({view, hand, kTick}, state);
      return z;
    };
    state.world_from_tool.translation.z = kStart;
    m.model->place(state.world_from_tool);
    double held_from = 0.0, most_free = 0.0;
    for (int tick = 0; tick < 400; ++tick) {
      const double z = step(tick);
      if ((state.flags & kContactOutsideWindow) == 0) {
        REQUIRE(held_from == 0.0);                                                         // once held, it stays held
        if (tick > 50) most_free = std::max(most_free, glm::length(state.on_hand.force));  // a body on a spring starts with a jerk
      } else if (held_from == 0.0) {
        held_from = z;
      }
      if (!m.where_hand_is) REQUIRE(state.world_from_tool.translation.z > 0.0);
    }
    // Bone may be near from 16 voxels on: two blocks; the cover adds the radius of a sphere, and a sample reaches sqrt(3).
    CHECK(held_from > 0.0);
    CHECK(held_from < 20.0 * kEdge);
    CHECK(most_free < 1e-3);
    CHECK(state.local.count == 0);
    // At rest the spring acts from the place of the tool, or where there is no such place from the last one that was read.
    const double from = m.where_hand_is ? held_from : state.world_from_tool.translation.z;
    CHECK(state.on_hand.force.z == doctest::Approx(m.spring * (from - kEnd)).epsilon(m.where_hand_is ? 0.02 : 1e-6));
    CHECK(state.force_gradient[2].z == -m.spring);

    bone.read_all();
    for (int tick = 400; tick < 800; ++tick) (void)step(tick);
    CHECK(state.flags == 0);
    CHECK(state.on_hand.force.z > 1.0);
    // Held again: a hand that goes on is pushed, one that leaves feels no force.
    const ContactState pressed = state;
    bone.read_corner();
    const auto at = [&](double z) {
      const HandMotion hand{{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, z)}, Vec3(0.0)};
      const BoneView view = bone.view();
      m.model->step({view, hand, kTick}, state);
      CHECK(state.flags == kContactOutsideWindow);
      return state.on_hand.force;
    };
    CHECK(at(kEnd - 0.5e-3).z > pressed.on_hand.force.z);
    CHECK(at(4e-3) == Vec3(0.0));
    CHECK(state.force_gradient == Mat3(0.0));
    state = pressed;
    if (m.name == "surface") CHECK(std::abs(state.world_from_tool.translation.z) < 0.5 * kEdge);
  }
}

TEST_CASE("unread bone: without the coarse distance nothing is known outside the window, so the tool is held at once") {
  PartlyRead bone;
  auto tool = ConstrainedTool::create({}, ball_shell(2e-3, 600), kEdge);
  REQUIRE(tool.ok());
  const Vec3 start(0.0, 0.0, 15e-3);
  tool->place({Quat(1.0, 0.0, 0.0, 0.0), start});
  SurfaceView view = *bone.view().surface;
  view.coarse = nullptr;
  (void)tool->step(view, {{Quat(1.0, 0.0, 0.0, 0.0), start - Vec3(0.0, 0.0, 1e-3)}, Vec3(0.0)}, kTick);
  CHECK(tool->state().flags == kContactOutsideWindow);
  CHECK(tool->state().world_from_tool.translation == start);
}
