// The contact model `mesh` with a tool that the triangles constrain: what it carries, that it stays on its side of bone, and its free motion.
#include <algorithm>

#include "core/base/units.h"
#include "core/mesh/mesh_contact.h"
#include "core/mesh/mesh_patch.h"
#include "core/mesh/mesh_tool.h"
#include "tests/core/contact/contact_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr double kDt = 1e-3;  ///< [s]
const ContactFields kFields{.density = true, .gradient = false, .words = false, .records = {}, .triangles = make_mesh_patch};
const double kThick = small_spec(PhantomKind::plate).thickness;

/// A ball of 1 mm on a 0.25 mm raster, its centre in the tool origin.
PointShell ball() {
  PointShell out;
  for (std::uint64_t n = 0; n < 400; ++n) {
    const double z = 1.0 - (2.0 * static_cast<double>(n) + 1.0) / 400.0, turn = 2.399963 * static_cast<double>(n);
    const Vec3 away(std::sqrt(1.0 - z * z) * std::cos(turn), std::sqrt(1.0 - z * z) * std::sin(turn), z);
    out.positions.push_back(1e-3 * away);
    out.inward_normals.push_back(-away);
    out.cutting.push_back(1);
  }
  return out;
}

class Held {
 public:
  explicit Held(const PhantomSpec& spec, const MeshToolConfig& config = {}) : bone_(phantom_of(spec).bone, {}, 0.08f, {}, kFields) {
    auto model = make_mesh_tool(config, ball(), {.voxel_edge = kPitch, .planes = true, .foresight = 2e-3});
    REQUIRE(model.ok());
    model_ = std::move(model).value();
  }
  void place(const Vec3& at) { model_->place({{}, at}); }
  const ContactState& step(const Vec3& hand, const Vec3& velocity = Vec3(0.0), const ToolSpin& spin = {}) {
    const HandMotion motion{.world_from_hand = {{}, hand}, .velocity = velocity};
    const BoneView view{bone_.view(), {}, {}, nullptr};
    model_->step({.bone = view, .hand = motion, .dt = kDt, .spin = spin}, state_);
    return state_;
  }
  const ContactState& settle(const Vec3& hand, const ToolSpin& spin = {}) {
    for (int n = 0; n < 60; ++n) step(hand, Vec3(0.0), spin);
    return state_;
  }

 private:
  FeltBone bone_;
  std::unique_ptr<ContactModel> model_;
  ContactState state_;
};

const PhantomSpec kPlate = small_spec(PhantomKind::plate);  // its face is z = 0

}  // namespace

TEST_CASE("mesh hold: a tool at rest stays on the surface under any thrust, and the springs carry it") {
  // From a light touch to a hand that is a whole plate and more beyond the face: the tool is where the face is. The shell's lowest point is
  // 1 mm (1 - 1/400) below the centre, and bone yields by F / 20 MN/m.
  for (const double beyond : {0.2e-3, 2e-3, 5.6e-3, 20e-3}) {
    CAPTURE(beyond);
    Held tool(kPlate);
    tool.place({0.0, 0.0, 2e-3});
    const ContactState& state = tool.settle({0.0, 0.0, 1e-3 - beyond});
    CHECK(state.flags == 0);
    CHECK(std::abs(state.world_from_tool.translation.z - 1e-3) < 0.02 * kPitch);
    CHECK(state.on_hand.force.z == doctest::Approx(5000.0 * (state.world_from_tool.translation.z - (1e-3 - beyond))).epsilon(0.01));
    CHECK(std::hypot(state.on_hand.force.x, state.on_hand.force.y) < 1e-2 * state.on_hand.force.z);
    // A hand that leaves feels nothing at once, and never an attractive force.
    for (double z = 1e-3 - beyond; z < 3e-3; z += 0.1e-3) CHECK(tool.step({0.0, 0.0, z}).on_hand.force.z >= 0.0);
    CHECK(tool.settle({0.0, 0.0, 3e-3}).on_hand.force == Vec3(0.0));
  }
}

TEST_CASE(
    "mesh hold: where the force at the hand's place has turned over on the far side, the constrained tool is still on the near side") {
  auto penalty = MeshContact::create({}, ball());
  REQUIRE(penalty.ok());
  const FeltBone bone(phantom_of(kPlate).bone, {}, 0.08f, {}, kFields);
  const Vec3 past(0.0, 0.0, -0.8 * kThick);
  CHECK(evaluated(**penalty, bone.view(), {{}, past}).wrench.force.z < 0.0);  // it pushes on, through the plate
  Held tool(kPlate);
  tool.place({0.0, 0.0, 2e-3});
  CHECK(tool.settle(past).on_hand.force.z > 10.0);
}

TEST_CASE("mesh hold: no stroke passes through bone, at any speed") {
  for (const double speed : {0.0625, 0.25, 1.25, 5.0}) {  // [m/s]; the last is 10 voxels a period
    CAPTURE(speed);
    Held tool(kPlate);
    Vec3 hand(0.3e-3, 0.2e-3, 3e-3);
    tool.place(hand);
    for (int n = 0; n < 40; ++n) {
      hand.z = std::max(hand.z - speed * kDt, -2.0 * kThick);
      const ContactState& state = tool.step(hand, {0.0, 0.0, -speed});
      REQUIRE(state.world_from_tool.translation.z > 1e-3 - 0.1 * kPitch);
    }
  }
}

TEST_CASE("mesh hold: a spinning tool engages by thrust over cutting stiffness") {
  Held tool(kPlate, {.cutting_stiffness = 60e3});
  const ToolSpin spin{.spinning = true, .rate = 100.0};
  tool.place({0.0, 0.0, 2e-3});
  const ContactState& state = tool.settle({0.0, 0.0, 1e-3 - 2e-3}, spin);  // 10 N at most, less by what is engaged
  const double force = state.on_hand.force.z;
  CHECK(force > 8.0);
  CHECK(state.engagement == doctest::Approx(force / 60e3).epsilon(1e-6));
  // Under the face by that: the ball's points apart from its lowest are higher by their distance, hundredths of a voxel.
  CHECK(std::abs(1e-3 - state.world_from_tool.translation.z - state.engagement) < 0.05 * kPitch);
  // The spin ends in bone: the tool is pushed out to the face and rests there.
  CHECK(std::abs(tool.settle({0.0, 0.0, -1e-3}).world_from_tool.translation.z - 1e-3) < 0.05 * kPitch);
}

TEST_CASE("mesh hold: bad configurations are refused") {
  const ContactOptions options{.voxel_edge = kPitch};
  CHECK_FALSE(make_mesh_tool({.coupling_stiffness = 0.0}, ball(), options).ok());
  CHECK_FALSE(make_mesh_tool({.coupling_damping = -1.0}, ball(), options).ok());
  CHECK_FALSE(make_mesh_tool({.max_moves = 0}, ball(), options).ok());
  CHECK_FALSE(make_mesh_tool({}, PointShell{}, options).ok());
  CHECK_FALSE(make_mesh_tool({}, ball(), {}).ok());
}
