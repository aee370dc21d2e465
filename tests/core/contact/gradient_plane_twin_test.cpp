// gradient_plane against a slow twin written from the paper's text, in both modes and both storages.
#include "contact_support.h"
#include "paper_twin.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr std::uint64_t kSeed = 20240611;

struct Case {
  std::string name;
  DenseBone bone;
  Pose world_from_bone;
};

std::vector<Case> every_bone() {
  std::vector<Case> cases;
  const auto add = [&](const std::string& name, const PhantomSpec& spec, const Pose& pose = {}) {
    cases.push_back({name, phantom_of(spec).bone, pose});
  };
  add("level plate", small_spec(PhantomKind::plate));
  PhantomSpec tilted = small_spec(PhantomKind::plate);
  tilted.plate_normal = Vec3(0.3, -0.2, 1.0);
  add("tilted plate", tilted);
  add("sphere", small_spec(PhantomKind::sphere));
  add("wedge", small_spec(PhantomKind::wedge));
  add("pit", small_spec(PhantomKind::pit));
  add("tilted plate, moved and turned", tilted, {random_rotation(kSeed, 1), Vec3(0.07, -0.02, 0.11)});
  PhantomSpec noisy = small_spec(PhantomKind::wedge);
  noisy.noise = 0.04;
  add("noisy wedge", noisy);
  add("sheared sphere, moved", small_spec(PhantomKind::sphere), {random_rotation(kSeed, 2), Vec3(-0.01, 0.02, 0.0)});
  cases.back().bone.bone_from_index.linear[2] += Vec3(0.2, -0.1, 0.1) * kPitch;
  return cases;
}

TwinBone twin_of(const FeltBone& felt) {
  TwinBone twin;
  const DenseBone& dense = felt.dense();
  std::size_t n = 0;
  for (int k = 0; k < dense.dims.z; ++k)
    for (int j = 0; j < dense.dims.y; ++j)
      for (int i = 0; i < dense.dims.x; ++i, ++n)
        if (dense.occupancy[n] > 0.0f) twin.density[{i, j, k}] = static_cast<double>(dense.occupancy[n]);
  // Columns of the map are the images of the unit steps.
  const Pose& pose = felt.world_from_bone();
  const Vec3 zero = pose * dense.bone_from_index.offset;
  for (int c = 0; c < 3; ++c) {
    const Vec3 step = pose.rotate(dense.bone_from_index.linear[c]);
    for (int r = 0; r < 3; ++r) twin.linear[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = step[r];
  }
  twin.offset = {zero.x, zero.y, zero.z};
  return twin;
}

Triple triple(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 vec(const Triple& t) { return {t[0], t[1], t[2]}; }

std::vector<TwinPoint> posed(const PointShell& shell, const Pose& pose) {
  std::vector<TwinPoint> points;
  for (std::size_t n = 0; n < shell.size(); ++n)
    points.push_back({triple(pose * shell.positions[n]), triple(pose.rotate(shell.inward_normals[n]))});
  return points;
}

/// Upright for even n, any rotation for odd; tip within 4 mm of the origin sideways, 2 mm deep to 0.5 mm above.
Pose tool_pose(std::uint64_t n, const Pose& world_from_bone) {
  const Vec3 tip = random_vector(kSeed, n) * Vec3(0.004, 0.004, 0.00125) - Vec3(0.0, 0.0, 0.00075);
  return world_from_bone * Pose{n % 2 == 0 ? Quat(1.0, 0.0, 0.0, 0.0) : random_rotation(kSeed, n), tip};
}

}  // namespace

TEST_CASE("gradient-plane: equals a slow twin of the paper's text, whatever bone, pose and mode") {
  MESSAGE("seed " << kSeed);
  const PointShell shell = shipped_shell("acosta_liu_round");
  std::size_t compared = 0;
  for (Case& c : every_bone()) {
    CAPTURE(c.name);
    const FeltBone bone(std::move(c.bone), c.world_from_bone);
    const TwinBone twin_bone = twin_of(bone);
    for (const bool paper : {false, true}) {
      CAPTURE(paper);
      GradientPlaneConfig config;
      config.paper_mode = paper;
      const auto model = model_of(shell, config);
      for (std::uint64_t n = 0; n < 24; ++n) {
        CAPTURE(n);
        const Pose pose = tool_pose(n, bone.world_from_bone());
        const ContactResult result = evaluated(*model, bone.view(), pose);
        const TwinAnswer twin = twin_force(twin_bone, {config.stiffness, paper}, posed(shell, pose), triple(pose.translation));
        REQUIRE(result.contacts.size() == twin.depths.size());
        CHECK(((result.flags & kContactNoSurface) != 0) == (twin.lost > 0));
        CHECK(((result.flags & kContactZeroGradient) != 0) == (twin.without_gradient > 0));
        // Two ways round of the same sums in double: 1e-9 of the largest force or torque that these depths could give.
        double reach = 1e-6;
        for (const double depth : twin.depths) reach = std::max(reach, depth);
        CHECK(glm::length(result.wrench.force - vec(twin.force)) <= 1e-9 * config.stiffness * reach);
        CHECK(glm::length(result.wrench.torque - vec(twin.torque)) <= 1e-9 * config.stiffness * reach * 0.004);
        compared += twin.depths.size();
      }
    }
  }
  CHECK(compared > 4000);  // the poses do touch bone
}

TEST_CASE("gradient-plane: dense window and OpenVDB grids give the same bits") {
  const PointShell shell = shipped_shell("acosta_liu_round");
  const auto same = [](const Vec3& a, const Vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; };
  for (Case& c : every_bone()) {
    CAPTURE(c.name);
    FeltBone bone(std::move(c.bone), c.world_from_bone);
    for (const bool paper : {false, true}) {
      GradientPlaneConfig config;
      config.paper_mode = paper;
      const auto model = model_of(shell, config);
      for (std::uint64_t n = 0; n < 16; ++n) {
        const Pose pose = tool_pose(n, bone.world_from_bone());
        const ContactResult window = evaluated(*model, bone.view(), pose), vdb = evaluated(*model, bone.vdb_view(), pose);
        REQUIRE(window.contacts.size() == vdb.contacts.size());
        CHECK(same(window.wrench.force, vdb.wrench.force));
        CHECK(same(window.wrench.torque, vdb.wrench.torque));
        CHECK(window.force_gradient == vdb.force_gradient);
        for (std::size_t i = 0; i < window.contacts.size(); ++i) {
          CHECK(same(window.contacts[i].plane_point, vdb.contacts[i].plane_point));
          CHECK(same(window.contacts[i].normal, vdb.contacts[i].normal));
        }
      }
    }
  }
}

TEST_CASE("gradient-plane: a law that skips the gradient walk does not pass for the paper's (sabotage)") {
  // The same comparison with a twin whose walk along the gradient is cut to one step must fail, or it would prove nothing.
  const PointShell shell = shipped_shell("acosta_liu_round");
  const FeltBone bone = felt(small_spec(PhantomKind::sphere));
  const TwinBone twin_bone = twin_of(bone);
  const auto model = model_of(shell);
  double worst = 0.0;
  for (std::uint64_t n = 0; n < 24; ++n) {
    const Pose pose = tool_pose(n, {});
    const TwinLaw lame{.longest_ascent = 1};
    const TwinAnswer twin = twin_force(twin_bone, lame, posed(shell, pose), triple(pose.translation));
    worst = std::max(worst, glm::length(evaluated(*model, bone.view(), pose).wrench.force - vec(twin.force)));
  }
  CHECK(worst > 0.1);  // [N]
}
