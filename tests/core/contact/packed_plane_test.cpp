// gradient_plane by vectors over packed words: equal to a plain twin over the same words, at every SIMD level.
#include <cstring>
#include <limits>

#include "contact_support.h"
#include "core/base/simd.h"
#include "words_twin.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr std::uint64_t kSeed = 20240707;

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
  PhantomSpec tilted = small_spec(PhantomKind::plate);
  tilted.plate_normal = Vec3(0.3, -0.2, 1.0);
  add("level plate", small_spec(PhantomKind::plate));
  add("tilted plate, moved and turned", tilted, {random_rotation(kSeed, 1), Vec3(0.07, -0.02, 0.11)});
  add("pit", small_spec(PhantomKind::pit));
  PhantomSpec noisy = small_spec(PhantomKind::wedge);
  noisy.noise = 0.04;
  add("noisy wedge", noisy);
  add("sheared sphere, moved", small_spec(PhantomKind::sphere), {random_rotation(kSeed, 2), Vec3(-0.01, 0.02, 0.0)});
  cases.back().bone.bone_from_index.linear[2] += Vec3(0.2, -0.1, 0.1) * kPitch;
  add("random", small_spec(PhantomKind::plate));
  for (std::size_t n = 0; n < cases.back().bone.occupancy.size(); ++n)
    cases.back().bone.occupancy[n] = static_cast<float>(std::max(0.0, uniform11(kSeed, n)));
  return cases;
}

Pose tool_pose(std::uint64_t n, const Pose& world_from_bone) {
  const Vec3 tip = random_vector(kSeed, n) * Vec3(0.004, 0.004, 0.00125) - Vec3(0.0, 0.0, 0.00075);
  return world_from_bone * Pose{n % 2 == 0 ? Quat(1.0, 0.0, 0.0, 0.0) : random_rotation(kSeed, n), tip};
}

bool same_bits(const ContactResult& a, const ContactResult& b) {
  if (a.contacts.size() != b.contacts.size() || a.flags != b.flags) return false;
  for (std::size_t n = 0; n < a.contacts.size(); ++n) {
    const Contact &x = a.contacts[n], &y = b.contacts[n];
    if (x.point != y.point || x.position != y.position || x.plane_point != y.plane_point || x.normal != y.normal || x.depth != y.depth)
      return false;
  }
  return a.wrench.force == b.wrench.force && a.wrench.torque == b.wrench.torque && a.force_gradient == b.force_gradient;
}

WordsTwin twin_of(const ContactView& view, const GradientPlaneConfig& config) {
  WordsTwin twin{view.box(), {view.words(), view.box().count()}, view.world_from_index(), view.index_from_world()};
  twin.stiffness = config.stiffness;
  twin.paper = config.paper_mode;
  twin.max_march = config.max_march;
  twin.max_ascent = config.max_ascent;
  return twin;
}

}  // namespace

TEST_CASE("packed gradient-plane: equals a plain twin over the same words, bit for bit, at every SIMD level") {
  MESSAGE("seed " << kSeed);
  const SimdLevelGuard guard;
  const PointShell shell = shipped_shell("acosta_liu_round");
  const std::vector<std::uint32_t> order = morton_order(shell.positions);
  std::vector<std::string> levels{"auto"};
  for (const SimdLevel level : simd_levels()) levels.emplace_back(name_of(level));
  std::size_t touched = 0;
  std::uint32_t flags = 0;
  for (Case& c : every_bone()) {
    CAPTURE(c.name);
    const VoxelBox tight{Vec3i(2), c.bone.dims - Vec3i(3, 2, 2)};
    for (const VoxelBox& window : {VoxelBox{}, tight}) {
      const FeltBone bone(c.bone, c.world_from_bone, 0.08f, window, kWordsOnly);
      const ContactView view = bone.view();
      for (const bool paper : {false, true})
        for (const int limit : {64, 3}) {
          const GradientPlaneConfig config{.paper_mode = paper, .max_march = limit, .max_ascent = limit};
          const auto model = model_of(shell, config);
          const WordsTwin twin = twin_of(view, config);
          for (std::uint64_t n = 0; n < 12; ++n) {
            CAPTURE(n);
            const Pose pose = tool_pose(n, bone.world_from_bone());
            const ContactResult plain = twin(shell, order, pose);
            touched += plain.contacts.size();
            flags |= plain.flags;
            for (const std::string& level : levels) {
              CAPTURE(level);
              REQUIRE(choose_simd(level).ok());
              CHECK(same_bits(evaluated(*model, view, pose), plain));
            }
          }
        }
    }
  }
  CHECK(touched > 8000);
  CHECK(flags == (kContactOutsideWindow | kContactNoSurface | kContactZeroGradient));  // every way out was met
}

TEST_CASE("packed gradient-plane: a twin that leaps twice as far as it may does not pass (sabotage)") {
  const PointShell shell = shipped_shell("acosta_liu_round");
  const FeltBone bone(phantom_of(small_spec(PhantomKind::sphere)).bone, {}, 0.08f, {}, kWordsOnly);
  const GradientPlaneConfig config;
  const auto model = model_of(shell, config);
  WordsTwin twin = twin_of(bone.view(), config);
  const auto differs = [&] {
    int different = 0;
    for (std::uint64_t n = 0; n < 40; ++n) {
      const Pose pose = tool_pose(n, {});
      different += same_bits(evaluated(*model, bone.view(), pose), twin(shell, morton_order(shell.positions), pose)) ? 0 : 1;
    }
    return different;
  };
  CHECK(differs() == 0);
  twin.trust_leaps = true;
  CHECK(differs() > 0);
}

TEST_CASE("packed gradient-plane: contacts name the caller's points and a place that is nonsense is outside") {
  const PhantomSpec spec = small_spec(PhantomKind::plate);
  const FeltBone bone(phantom_of(spec).bone, {}, 0.08f, {}, kWordsOnly);
  PointShell shell = shell_of({});
  for (std::uint64_t n = 0; n < 300; ++n) shell.positions.push_back(1e-3 * random_vector(5, n));
  shell.inward_normals.assign(300, Vec3(0.0, 0.0, 1.0));
  shell.cutting.assign(300, 1);
  const auto model = model_of(shell);
  const Pose pose{{}, Vec3(0.0, 0.0, -0.5e-3)};
  const ContactResult result = evaluated(*model, bone.view(), pose);
  REQUIRE(result.contacts.size() > 100);
  // 1/16384 voxel to either side on each axis, halved by rounding: 0.5 sqrt(3) / 16384 of 0.5 mm.
  for (const Contact& contact : result.contacts)
    CHECK(glm::length(contact.position - pose * shell.positions[contact.point]) < 0.87 / 16384.0 * kPitch);
  CHECK(result.contacts.size() == evaluated(*model, felt(spec).view(), pose).contacts.size());
  for (const double far : {1e3, 1e9, -1e9, 1e300, -1e300}) {
    const ContactResult outside = evaluated(*model, bone.view(), {{}, Vec3(far, 0.0, -0.5e-3)});
    CHECK(outside.flags == kContactOutsideWindow);
    CHECK(outside.contacts.empty());
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(evaluated(*model, bone.view(), {{}, Vec3(0.0, nan, 0.0)}).flags == kContactNotFinite);
}

TEST_CASE("packed gradient-plane: without a list of contacts all else is the same bits") {
  const PointShell shell = shipped_shell("acosta_liu_round");
  const FeltBone bone(phantom_of(small_spec(PhantomKind::sphere)).bone, {}, 0.08f, {}, kWordsOnly);
  const SimdLevelGuard guard;
  std::vector<std::string> levels{"auto"};
  for (const SimdLevel level : simd_levels()) levels.emplace_back(name_of(level));
  std::size_t touched = 0;
  for (const bool paper : {false, true}) {
    const auto model = model_of(shell, {.paper_mode = paper});
    for (std::uint64_t n = 0; n < 40; ++n)
      for (const std::string& level : levels) {
        CAPTURE(level);
        REQUIRE(choose_simd(level).ok());
        ContactResult listed, unlisted;
        unlisted.list_contacts = false;
        model->evaluate(bone.view(), tool_pose(n, {}), listed);
        model->evaluate(bone.view(), tool_pose(n, {}), unlisted);
        double deepest = 0.0;
        for (const Contact& contact : listed.contacts) deepest = std::max(deepest, contact.depth);
        CHECK(unlisted.contacts.empty());
        for (const ContactResult* result : {&listed, &unlisted}) {
          CHECK(result->touching == listed.contacts.size());
          CHECK(result->deepest == deepest);
        }
        touched += unlisted.touching;
        unlisted.contacts = listed.contacts;
        CHECK(same_bits(listed, unlisted));
      }
  }
  CHECK(touched > 1000);
}

TEST_CASE("packed gradient-plane: evaluating into a reserved result does not allocate") {
  const PointShell shell = shipped_shell("acosta_liu_round");
  const FeltBone bone(phantom_of(small_spec(PhantomKind::plate)).bone, {}, 0.08f, {}, kWordsOnly);
  const auto model = model_of(shell);
  ContactResult result;
  result.contacts.reserve(shell.size());
  const Contact* const where = result.contacts.data();
  model->evaluate(bone.view(), {{}, Vec3(0.0, 0.0, -2e-3)}, result);
  CHECK(!result.contacts.empty());
  CHECK(result.contacts.data() == where);
}
