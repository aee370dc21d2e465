// voxmap_contact against a slow twin written from the paper's text: every stacking, plane, mode and storage.
#include "voxmap_twin.h"
#include "contact_support.h"
#include "core/contact/voxmap_contact.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr std::uint64_t kSeed = 19990808;
constexpr std::array<std::pair<Stacking, TwinStack>, 4> kStackings{{{Stacking::sum, TwinStack::added},
                                                                    {Stacking::sum_limited, TwinStack::tenth_limited},
                                                                    {Stacking::average, TwinStack::mean},
                                                                    {Stacking::deepest, TwinStack::petersik}}};

struct Case {
  std::string name;
  DenseBone bone;
  Pose world_from_bone;
};

std::vector<Case> every_bone() {
  std::vector<Case> cases;
  cases.push_back({"level plate", phantom_of(small_spec(PhantomKind::plate)).bone, {}});
  PhantomSpec tilted = small_spec(PhantomKind::plate);
  tilted.plate_normal = Vec3(0.3, -0.2, 1.0);
  cases.push_back({"tilted plate, moved and turned", phantom_of(tilted).bone, {random_rotation(kSeed, 1), Vec3(0.07, -0.02, 0.11)}});
  PhantomSpec noisy = small_spec(PhantomKind::wedge);
  noisy.noise = 0.04;
  cases.push_back({"noisy wedge", phantom_of(noisy).bone, {}});
  cases.push_back({"pit", phantom_of(small_spec(PhantomKind::pit)).bone, {}});
  cases.push_back(
      {"sheared sphere, moved", phantom_of(small_spec(PhantomKind::sphere)).bone, {random_rotation(kSeed, 2), Vec3(-0.01, 0.02, 0.0)}});
  cases.back().bone.bone_from_index.linear[2] += Vec3(0.2, -0.1, 0.1) * kPitch;
  return cases;
}

Triple triple(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 vec(const Triple& t) { return {t[0], t[1], t[2]}; }

TwinBone twin_of(const FeltBone& felt) {
  TwinBone twin;
  const DenseBone& dense = felt.dense();
  for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
    const float occupancy = dense.occupancy[VoxelBox{Vec3i(0), dense.dims}.offset_of(v)];
    if (occupancy > 0.0f) twin.density[{v.x, v.y, v.z}] = static_cast<double>(occupancy);
  });
  const Pose& pose = felt.world_from_bone();
  twin.offset = triple(pose * dense.bone_from_index.offset);
  for (int c = 0; c < 3; ++c) {
    const Vec3 step = pose.rotate(dense.bone_from_index.linear[c]);
    for (int r = 0; r < 3; ++r) twin.linear[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = step[r];
  }
  return twin;
}

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

std::unique_ptr<PenaltyModel> voxmap_of(const PointShell& shell, const VoxmapContactConfig& config) {
  auto model = VoxmapContact::create(config, shell);
  REQUIRE(model.ok());
  return std::move(model).value();
}

/// Calls f(config, matching law) for each of the 16 variants.
template <class F>
void for_each_law(F&& f) {
  for (const auto& [stacking, stack] : kStackings)
    for (const bool surface : {false, true})
      for (const bool paper : {false, true}) {
        CAPTURE(static_cast<int>(stacking));
        CAPTURE(surface);
        CAPTURE(paper);
        f(VoxmapContactConfig{.stacking = stacking, .plane_voxel = surface ? PlaneVoxel::surface : PlaneVoxel::own, .paper_mode = paper},
          VoxmapTwinLaw{.stack = stack, .walk_to_surface = surface, .any_density_collides = paper});
      }
}

/// Largest difference of force [N] over 24 poses.
double worst_difference(const FeltBone& bone, const PointShell& shell, const VoxmapContactConfig& config, const VoxmapTwinLaw& law) {
  const TwinBone twin_bone = twin_of(bone);
  const auto model = voxmap_of(shell, config);
  double worst = 0.0;
  for (std::uint64_t n = 0; n < 24; ++n) {
    const Pose pose = tool_pose(n, bone.world_from_bone());
    const VoxmapTwinAnswer twin = voxmap_twin_force(twin_bone, law, posed(shell, pose), triple(pose.translation));
    worst = std::max(worst, glm::length(evaluated(*model, bone.view(), pose).wrench.force - vec(twin.force)));
  }
  return worst;
}

}  // namespace

TEST_CASE("voxmap: equals a slow twin of the paper's text, whatever bone, pose, stacking and plane") {
  MESSAGE("seed " << kSeed);
  const PointShell shell = shipped_shell("acosta_liu_round");
  std::size_t compared = 0, lost = 0;
  for (Case& c : every_bone()) {
    CAPTURE(c.name);
    const FeltBone bone(std::move(c.bone), c.world_from_bone);
    const TwinBone twin_bone = twin_of(bone);
    for_each_law([&](VoxmapContactConfig config, VoxmapTwinLaw law) {
      config.max_march = law.longest_march = 6;  // some marches must meet it
      const auto model = voxmap_of(shell, config);
      for (std::uint64_t n = 0; n < 12; ++n) {
        CAPTURE(n);
        const Pose pose = tool_pose(n, bone.world_from_bone());
        const ContactResult result = evaluated(*model, bone.view(), pose);
        const VoxmapTwinAnswer twin = voxmap_twin_force(twin_bone, law, posed(shell, pose), triple(pose.translation));
        REQUIRE(result.contacts.size() == twin.depths.size());
        CHECK(((result.flags & kContactNoSurface) != 0) == (twin.lost > 0));
        // Two ways round of the same sums: 1e-9 of what the points' vectors add up to, whether or not they cancel.
        double reach = 1e-6;
        for (std::size_t i = 0; i < twin.depths.size(); ++i) {
          CHECK(std::abs(result.contacts[i].depth - twin.depths[i]) <= 1e-12);  // [m]
          reach += twin.depths[i];
        }
        CHECK(glm::length(result.wrench.force - vec(twin.force)) <= 1e-9 * config.stiffness * reach);
        CHECK(glm::length(result.wrench.torque - vec(twin.torque)) <= 1e-9 * config.stiffness * reach * 0.004);
        compared += twin.depths.size();
        lost += static_cast<std::size_t>(twin.lost);
      }
    });
  }
  CHECK(compared > 10000);  // the poses do touch bone
  CHECK(lost > 100);
}

TEST_CASE("voxmap: dense window and OpenVDB grids give the same bits") {
  const PointShell shell = shipped_shell("acosta_liu_round");
  for (Case& c : every_bone()) {
    CAPTURE(c.name);
    FeltBone bone(std::move(c.bone), c.world_from_bone);
    for_each_law([&](const VoxmapContactConfig& config, const VoxmapTwinLaw&) {
      const auto model = voxmap_of(shell, config);
      for (std::uint64_t n = 0; n < 4; ++n) {
        const Pose pose = tool_pose(n, bone.world_from_bone());
        const ContactResult window = evaluated(*model, bone.view(), pose), vdb = evaluated(*model, bone.vdb_view(), pose);
        REQUIRE(window.contacts.size() == vdb.contacts.size());
        CHECK(window.wrench.force == vdb.wrench.force);
        CHECK(window.wrench.torque == vdb.wrench.torque);
        CHECK(window.force_gradient == vdb.force_gradient);
      }
    });
  }
}

TEST_CASE("voxmap: the order of the points does not matter") {
  const FeltBone bone = felt(small_spec(PhantomKind::wedge));
  const PointShell shell = shipped_shell("acosta_liu_round");
  PointShell shuffled = shell;
  for (std::size_t n = shell.size(); n > 1; --n) {
    const auto other = static_cast<std::size_t>(uniform01(kSeed, n) * static_cast<double>(n));
    std::swap(shuffled.positions[n - 1], shuffled.positions[other]);
    std::swap(shuffled.inward_normals[n - 1], shuffled.inward_normals[other]);
  }
  for_each_law([&](const VoxmapContactConfig& config, const VoxmapTwinLaw&) {
    const auto model = voxmap_of(shell, config), other = voxmap_of(shuffled, config);
    for (std::uint64_t n = 0; n < 12; ++n) {
      const ContactResult a = evaluated(*model, bone.view(), tool_pose(n, {})), b = evaluated(*other, bone.view(), tool_pose(n, {}));
      CHECK(a.contacts.size() == b.contacts.size());
      // Sums of at most 72 terms of at most 10 N, rounded in another order.
      CHECK(glm::length(a.wrench.force - b.wrench.force) <= 1e-12);
      CHECK(glm::length(a.wrench.torque - b.wrench.torque) <= 1e-14);
    }
  });
}

TEST_CASE("voxmap: the twin would not pass for another law (sabotage)") {
  const PointShell shell = shipped_shell("acosta_liu_round");
  const FeltBone bone = felt(small_spec(PhantomKind::sphere));
  for (const auto& [stacking, stack] : kStackings) {
    CAPTURE(static_cast<int>(stacking));
    const VoxmapContactConfig config{.stacking = stacking};
    CHECK(worst_difference(bone, shell, config, {.stack = stack}) <= 1e-9);  // [N]
    // Half a voxel out is a plane on the facet; a twelfth of a newton is the least that any stacking makes of it.
    CHECK(worst_difference(bone, shell, config, {.stack = stack, .plane_offset = 0.5}) > 0.05);
    CHECK(worst_difference(bone, shell, config, {.stack = stack, .walk_to_surface = true}) > 0.05);
    for (const auto& [other, other_stack] : kStackings)
      if (other != stacking) CHECK(worst_difference(bone, shell, config, {.stack = other_stack}) > 0.01);
  }
}
