// Every shipped bit drills a thin plate through the shipped path: bone goes where its active faces pass and nowhere else; with the spindle
// at rest or with factors of 0 none goes; the hole has the bit's shape. And the predicted feed is the simulated one.

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <vector>

#include "core/drill/removal_rate.h"
#include "tests/support/drill_scene.h"
#include "tests/support/source_folder.h"

namespace burrhole::test {
namespace {

/// What a bit needs to get through a plate in a second or so of simulated time.
struct BitCase {
  std::string name;
  double across_mm;  ///< of the plate
  double spacing_mm;
  double erosion_scale;  ///< so that it is through soon
  double down_mm;        ///< of the tip under the plate's outer face when the hole is looked at
};

// Down to where the widest cutting place is in the plate's inner face, and a little more.
const BitCase kBits[] = {{"acorn_burr_7_5mm", 12.0, 0.25, 10.0, 7.0},  {"acosta_liu_perforator", 18.0, 0.25, 10.0, 2.5},
                         {"acosta_liu_round", 8.0, 0.2, 5.0, 3.5},     {"matchstick_burr_3mm", 7.0, 0.2, 10.0, 3.0},
                         {"perforator_14_11", 18.0, 0.25, 20.0, 5.5},  {"round_burr_2mm", 6.0, 0.2, 10.0, 2.5},
                         {"round_burr_3mm", 7.0, 0.2, 10.0, 3.0},      {"round_burr_4mm", 8.0, 0.25, 10.0, 3.5},
                         {"round_burr_5mm", 9.0, 0.25, 10.0, 4.0},     {"round_burr_6mm", 10.0, 0.25, 10.0, 4.5},
                         {"sagittal_saw_12mm", 16.0, 0.15, 10.0, 2.0}, {"trephine_12mm", 16.0, 0.25, 10.0, 2.0},
                         {"twist_drill_2_5mm", 6.0, 0.2, 5.0, 2.5}};

constexpr double kThickness = 1.25e-3;  // [m] of the plate

/// A hand of the test's own, with an eye on every tick.
class WatchedSource final : public HandSource {
 public:
  WatchedSource(HandSource* hand, std::function<void()> watch) : hand_(hand), watch_(std::move(watch)) {}
  [[nodiscard]] const HandState& read() noexcept override { return hand_->read(); }
  void apply(const Wrench& on_hand) noexcept override {
    watch_();
    hand_->apply(on_hand);
  }

 private:
  HandSource* hand_;
  std::function<void()> watch_;
};

SmallScene plate_for(const BitCase& bit, const std::vector<std::string>& more = {}) {
  const std::string across = std::to_string(bit.across_mm);
  SmallScene scene{.volume = "source = \"phantom:plate\"\nspacing_mm = " + std::to_string(bit.spacing_mm) + "\nextent_mm = [" + across +
                             ", " + across + ", 5.0]\nabove_mm = 1.5\nthickness_mm = 1.25\nhardness = 0.8\n"};
  scene.sets = {"tool.name=" + bit.name, "tool.erosion_scale=" + std::to_string(bit.erosion_scale),
                "hand.detects=false",    "hand.ramp_s=0.05",
                "hand.standoff_mm=0.3",  "duration_s=6"};
  scene.sets.insert(scene.sets.end(), more.begin(), more.end());
  return scene;
}

/// A run until the tip is down, and the way the bit took.
struct Drilled {
  std::unique_ptr<DrillRun> run;
  std::vector<Pose> path;  ///< of the tool in bone, each millisecond
  std::vector<float> density;

  [[nodiscard]] const BoneModel& bone() const { return *run->loaded().bone; }
  [[nodiscard]] const Tool& tool() const { return run->loaded().tool; }
  [[nodiscard]] std::size_t offset(const Vec3i& v) const {
    const Vec3i d = bone().dims();
    return static_cast<std::size_t>((v.z * d.y + v.y) * d.x + v.x);
  }
  [[nodiscard]] float at(const Vec3i& v) const { return density[offset(v)]; }
  [[nodiscard]] Vec3 place(const Vec3i& v) const { return bone().bone_from_index() * Vec3(v); }
  /// Layer of voxels nearest under a height.
  [[nodiscard]] int layer(double z) const {
    int k = 0;
    while (place({0, 0, k}).z < z) ++k;
    return k;
  }
  [[nodiscard]] double removed() { return run->simulation().bone_step().removed_mass(); }
};

/// `hand` holds the drill, or the scene's own hand when there is none; ends when `finished` says so.
Drilled drill(const SmallScene& scene, const std::function<bool(Simulation&)>& finished, HandSource* hand = nullptr) {
  std::atomic<bool> stop{false};
  SimulationOptions options;
  Simulation* simulation = nullptr;
  LoadedScene loaded = load_small(scene);
  Drilled out;
  const auto look = [&] {
    out.path.push_back(simulation->contact_state().world_from_tool);
    stop = finished(*simulation);
  };
  WatchedHand own(loaded, look);
  WatchedSource given(hand, look);
  options.hand = hand != nullptr ? static_cast<HandSource*>(&given) : &own;
  options.stop = &stop;
  out.run = std::make_unique<DrillRun>(std::move(loaded), options);
  simulation = &out.run->simulation();
  out.run->run();
  const Vec3i d = out.bone().dims();
  out.density.resize(static_cast<std::size_t>(d.x) * static_cast<std::size_t>(d.y) * static_cast<std::size_t>(d.z));
  simulation->voxmap().read_density({Vec3i(0), d}, out.density);
  return out;
}

/// Slow twin of where a bit can have cut, on the way in steps of a fifth of a voxel: every voxel whose samples, up to a voxel from its
/// centre along each axis (coverage_samples.h), may lie in the cell of an erosion point, up to a quarter voxel from the point.
std::vector<char> reached(const Drilled& hole) {
  const Vec3i d = hole.bone().dims();
  std::vector<char> marks(hole.density.size(), 0);
  const Affine index_from_bone = hole.bone().bone_from_index().inverse();
  const double step = 0.2 * hole.run->voxel();
  const Vec3 reach(1.0 + 0.25 + 0.1);  // the last: half a step
  Pose from = hole.path.front();
  for (const Pose& to : hole.path) {
    const double way = glm::length(to.translation - from.translation);
    if (way < step) continue;
    const int parts = static_cast<int>(std::ceil(way / step));
    for (int n = 1; n <= parts; ++n) {
      const double share = static_cast<double>(n) / parts;
      const Pose tool{glm::slerp(from.rotation, to.rotation, share), glm::mix(from.translation, to.translation, share)};
      if (tool.translation.z > 0.5e-3) continue;  // above the bone
      const Affine index_from_tool = index_from_bone * Affine::from_pose(tool);
      for (const Vec3& point : hole.tool().erosion.positions) {
        const Vec3 p = index_from_tool * point;
        const VoxelBox near{-floor_int(reach - p), floor_int(p + reach) + 1};
        for_each_voxel(near.intersect({Vec3i(0), d}), [&](const Vec3i& v) { marks[hole.offset(v)] = 1; });
      }
    }
    from = to;
  }
  return marks;
}

/// Lowest erosion point of the bit within `reach` of the line through (x, y) along its axis; far up where there is none.
double lowest_point(const Tool& tool, double x, double y, double reach) {
  double low = 1e9;
  for (const Vec3& p : tool.erosion.positions)
    if (std::max(std::abs(p.x - x), std::abs(p.y - y)) < reach) low = std::min(low, p.z);
  return low;
}

/// Plain outcome of one case.
Drilled drill_case(const BitCase& bit, const std::vector<std::string>& more = {}) {
  return drill(plate_for(bit, more), [&](Simulation& simulation) { return simulation.progress().depth > bit.down_mm * 1e-3; });
}

const BitCase& case_of(const std::string& name) {
  return *std::find_if(std::begin(kBits), std::end(kBits), [&](const BitCase& bit) { return bit.name == name; });
}

}  // namespace

TEST_CASE("shipped bits: every one has its drilling case, but the craniotome, which has one of its own below") {
  std::set<std::string> cases{"craniotome_2_3mm"}, files;
  for (const BitCase& bit : kBits) cases.insert(bit.name);
  for (const auto& entry : std::filesystem::directory_iterator(test::in_source("app/tools"))) files.insert(entry.path().stem().string());
  CHECK(cases == files);
}

TEST_CASE("shipped bits: bone goes where active faces pass, all of it, and nowhere else") {
  for (const BitCase& bit : kBits) {
    CAPTURE(bit.name);
    Drilled hole = drill_case(bit);
    const double voxel = hole.run->voxel(), depth = hole.run->simulation().progress().depth;
    CHECK(depth > bit.down_mm * 1e-3);
    const std::vector<char> marks = reached(hole);
    const Vec3i d = hole.bone().dims();
    std::size_t stray = 0, left = 0, gone = 0;
    const int middle = hole.layer(-0.5 * kThickness);
    for_each_voxel({Vec3i(0), d}, [&](const Vec3i& v) {
      const float loaded = hole.bone().occupancy(v), density = hole.at(v);
      if (density < loaded && marks[hole.offset(v)] == 0) ++stray;
      if (v.z != middle) return;
      // Points have been there for two voxels and the engaged depth of 0.5 mm: long enough to be through at this feed.
      const Vec3 p = hole.place(v);
      if (lowest_point(hole.tool(), p.x, p.y, 0.2 * voxel) < p.z + depth - 2.0 * voxel - 0.5e-3 && density >= 0.5f) ++left;
      if (density < 0.5f) ++gone;
    });
    MESSAGE(bit.name << ": down " << depth * 1e3 << " mm after " << hole.run->simulation().time() << " s, " << hole.removed() * 1e9
                     << " mm3, " << gone << " voxels gone in the middle layer");
    CHECK(stray == 0);
    CHECK(left == 0);
    CHECK(gone > 4);
  }
}

TEST_CASE("shipped bits: at rest, or with factors of 0, nothing is removed, and the bit stays on the bone") {
  for (const BitCase& bit : kBits)
    for (const std::string off : {"tool.spin_rpm=0", "tool.erosion_scale=0"}) {
      CAPTURE(bit.name);
      CAPTURE(off);
      Drilled run = drill(plate_for(bit, {off, "duration_s=0.4"}), [](Simulation&) { return false; });
      CHECK(run.removed() == 0.0);
      CHECK(run.run->simulation().progress().peak_force > 10.0);
      // at rest a twentieth of a voxel; spinning, the cutting points may be engaged by F / K_cut = 0.5 mm, more where they are oblique
      const bool rest = off == "tool.spin_rpm=0";
      CHECK(run.run->simulation().progress().depth < (rest ? 0.1 * run.run->voxel() : 2.5e-3));
    }
}

TEST_CASE("trephine: a core stands on the axis, free all round") {
  const Drilled hole = drill_case(case_of("trephine_12mm"));
  const Vec3i d = hole.bone().dims();
  const double voxel = hole.run->voxel();
  std::size_t core = 0, ring = 0, beyond = 0;
  for_each_voxel({Vec3i(0), d}, [&](const Vec3i& v) {
    const Vec3 p = hole.place(v);
    if (p.z > 0.0 || p.z < -kThickness || hole.bone().occupancy(v) < 1.0f) return;
    const double r = std::hypot(p.x, p.y);
    // A voxel and a half of room for the stairs of a circle and for the bit's sway.
    if (r < 5e-3 - 1.5 * voxel) core += hole.at(v) < 1.0f ? 1 : 0;
    if (r > 5e-3 + 0.75 * voxel && r < 6e-3 - 0.75 * voxel) ring += hole.at(v) >= 0.5f ? 1 : 0;
    if (r > 6e-3 + 1.5 * voxel) beyond += hole.at(v) < 1.0f ? 1 : 0;
  });
  CHECK(core == 0);
  CHECK(ring == 0);
  CHECK(beyond == 0);
}

TEST_CASE("saw: a slot as wide as the kerf and as long as the blade") {
  const Drilled cut = drill_case(case_of("sagittal_saw_12mm"));
  const double voxel = cut.run->voxel();
  const Vec3i d = cut.bone().dims();
  const int middle = cut.layer(-0.5 * kThickness);
  double width = 0.0, length = 0.0;  // [m] between the walls: what is under the 0.5 level
  for (int j = 0; j < d.y; ++j) width += cut.at({d.x / 2, j, middle}) < 0.5f ? voxel : 0.0;
  for (int i = 0; i < d.x; ++i) length += cut.at({i, d.y / 2, middle}) < 0.5f ? voxel : 0.0;
  MESSAGE("slot " << width * 1e3 << " x " << length * 1e3 << " mm");
  // A voxel: points remove whole cells, and those of the kerf's two rims may be wide by half a cell each.
  CHECK(std::abs(width - 0.6e-3) <= 1.01 * voxel);
  CHECK(std::abs(length - 12e-3) <= 1.01 * voxel);
}

namespace {

/// A machine that holds the drill: from place to place at a constant speed each, whatever it feels. World frame.
class Rail final : public HandSource {
 public:
  struct Leg {
    Vec3 to;       // [m]
    double speed;  // [m/s]
  };
  Rail(const Vec3& start, std::vector<Leg> legs) : legs_(std::move(legs)) { state_.world_from_hand.translation = start; }
  [[nodiscard]] const HandState& read() noexcept override { return state_; }
  void apply(const Wrench&) noexcept override {
    constexpr double kTick = 1e-3;
    state_.phase = HandPhase::lean;
    ++state_.tick;
    state_.velocity = Vec3(0.0);
    if (done()) return;
    const Vec3 left = legs_[leg_].to - state_.world_from_hand.translation;
    const double length = glm::length(left);
    const double move = legs_[leg_].speed * kTick;
    state_.velocity = length > 0.0 ? left / length * legs_[leg_].speed : Vec3(0.0);
    state_.world_from_hand.translation += length > move ? left / length * move : left;
    if (length <= move) ++leg_;
  }
  [[nodiscard]] bool done() const noexcept { return leg_ >= legs_.size(); }

 private:
  std::vector<Leg> legs_;
  std::size_t leg_ = 0;
  HandState state_;
};

constexpr const char* kFlap = R"(source = "phantom:block"
spacing_mm = 0.25
extent_mm = [14.0, 12.0, 6.0]
above_mm = 1.5
block_mm = [6.0, 8.0, 2.0]
hardness = 0.8
)";

}  // namespace

TEST_CASE("craniotome: the router cuts sideways, its foot cuts nothing and bears on the inner face") {
  const SmallScene scene{.volume = kFlap,
                         .sets = {"tool.name=craniotome_2_3mm", "tool.erosion_scale=20", "hand.standoff_mm=0.5", "duration_s=4"}};
  // Beside the block, down until the foot's top is 0.3 mm under the inner face, on to the block's middle, then up by 2 mm.
  Rail rail({0.0, 0.0, 0.5e-3}, {{{-8e-3, 0.0, 0.5e-3}, 0.04},
                                 {{-8e-3, 0.0, -3.3e-3}, 0.04},
                                 {{0.0, 0.0, -3.3e-3}, 0.006},
                                 {{0.0, 0.0, -3.3e-3}, 0.006},
                                 {{0.0, 0.0, -1.3e-3}, 0.01}});
  int rest = 0;
  const Drilled kerf = drill(
      scene, [&](Simulation&) { return rail.done() && ++rest > 300; }, &rail);
  Simulation& simulation = kerf.run->simulation();
  const double voxel = kerf.run->voxel();
  const Vec3i d = kerf.bone().dims();
  const Vec3 tip = kerf.path.back().translation;
  std::size_t left = 0, stray = 0;
  for_each_voxel({Vec3i(0), d}, [&](const Vec3i& v) {
    const Vec3 p = kerf.place(v);
    const float loaded = kerf.bone().occupancy(v);
    if (loaded < 1.0f) return;
    const bool behind = p.x < tip.x && std::abs(p.y) < 1.15e-3 - voxel;
    // Outside the router's way by a voxel and a half, over, beside and ahead of the foot.
    const bool outside = std::abs(p.y) > 1.15e-3 + 1.5 * voxel || p.x > tip.x + 1.15e-3 + 1.5 * voxel;
    if (behind && kerf.at(v) >= 0.5f) ++left;
    if (outside && kerf.at(v) < loaded) ++stray;
  });
  MESSAGE("tip at " << tip.x * 1e3 << ", " << tip.y * 1e3 << ", " << tip.z * 1e3 << " mm, force "
                    << simulation.contact_state().on_hand.force.z << " N");
  CHECK(left == 0);
  CHECK(stray == 0);
  // The coupling's 5 kN/m pull it along: it stays behind by what engages it a voxel deep, 0.25 mm at 40 kN/m, less than which cuts little.
  CHECK(tip.x > -2.1e-3);
  // The foot is 1 mm thick and the inner face at -2 mm: it holds to a tenth of a voxel, and the coupling's 5 kN/m pull on it.
  CHECK(std::abs(tip.z + 3e-3) < 0.1 * voxel + 1e-6);
  CHECK(simulation.contact_state().on_hand.force.z == doctest::Approx(-5000.0 * 1.7e-3).epsilon(0.05));
}

TEST_CASE("craniotome: at rest neither router nor foot cuts") {
  for (const std::string off : {"tool.spin_rpm=0", "tool.erosion_scale=0"}) {
    const SmallScene scene{.volume = kFlap, .sets = {"tool.name=craniotome_2_3mm", off, "hand.standoff_mm=0.5", "duration_s=3"}};
    Rail rail({0.0, 0.0, 0.5e-3}, {{{-8e-3, 0.0, 0.5e-3}, 0.04}, {{-8e-3, 0.0, -3.3e-3}, 0.04}, {{-2e-3, 0.0, -3.3e-3}, 0.006}});
    Drilled run = drill(
        scene, [&](Simulation&) { return rail.done(); }, &rail);
    CHECK(run.removed() == 0.0);
    CHECK(run.run->simulation().progress().peak_force > 5.0);
  }
}

namespace {

struct FeedCase {
  std::string name;
  double across_mm, spacing_mm, from_mm, to_mm;
  double cutting_stiffness = 40e3;  ///< [N/m]
};

/// @returns the feed in a thick plate between two depths over the predicted one.
double feed_of(const FeedCase& c) {
  const std::string across = std::to_string(c.across_mm);
  SmallScene scene{.volume = "source = \"phantom:plate\"\nspacing_mm = " + std::to_string(c.spacing_mm) + "\nextent_mm = [" + across +
                             ", " + across + ", 10.0]\nabove_mm = 1.5\nthickness_mm = 7.0\nhardness = 0.8\n"};
  scene.sets = {"tool.name=" + c.name, "hand.detects=false", "duration_s=30",
                "erosion.rate_hz=250", "hand.tremor_mm=0",   "contact.cutting_N_per_m=" + std::to_string(c.cutting_stiffness)};
  double force = 0.0, engaged = 0.0;
  int looks = 0;
  const Drilled run = drill(scene, [&](Simulation& simulation) {
    const double depth = simulation.progress().depth;
    if (depth > c.from_mm * 1e-3) {
      force += simulation.servo_output().force.z;
      engaged += simulation.contact_state().engagement;
      ++looks;
    }
    return depth > c.to_mm * 1e-3;
  });
  const Simulation& simulation = run.run->simulation();
  const double speed =
      (c.to_mm - c.from_mm) * 1e-3 / (time_at_depth(simulation, c.to_mm * 1e-3) - time_at_depth(simulation, c.from_mm * 1e-3));
  const FeedConditions conditions{
      .thrust = force / looks, .spin = 1000.0 / 60.0, .hardness = 0.8, .cutting_stiffness = c.cutting_stiffness};
  const FeedPrediction predicted = predict_feed(run.tool(), FeedDirection::plunge, conditions);
  MESSAGE(c.name << ": simulated " << speed * 1e3 << " mm/s, predicted " << predicted.speed * 1e3 << " mm/s, ratio "
                 << speed / predicted.speed << ", thrust " << conditions.thrust << " N, engaged " << engaged / looks * 1e3 << " mm");
  return speed / predicted.speed;
}

// Where all of the end cuts alike, the whole face lags by F / K_cut. The steps of bone take lambda dt / 2 of the feed, 3 % at most here, and a
// plane's own give 2 %; the rest of the 10 % is for the corner between floor and wall.
TEST_CASE("predicted feed: within 10 % for ends that cut alike all over") {
  for (const FeedCase& c : {FeedCase{"acosta_liu_perforator", 17.0, 0.2, 1.4, 2.6},
                            {"perforator_14_11", 17.0, 0.25, 3.5, 4.5},
                            {"trephine_12mm", 15.0, 0.25, 1.5, 3.0},
                            {"sagittal_saw_12mm", 14.0, 0.15, 0.5, 0.8, 100e3}}) {
    CAPTURE(c.name);
    CHECK(std::abs(feed_of(c) - 1.0) < 0.1);
  }
}

// The prediction takes the weakest part of the end to carry the thrust. A weak part that is smaller than the engaged depth does not: bone is
// taken off it from beside. So these are known to 20 %, which docs/bits.md says.
TEST_CASE("predicted feed: within 20 % where the axis cuts less than the rim, and for a thin twist drill") {
  for (const FeedCase& c : {FeedCase{"twist_drill_2_5mm", 6.0, 0.25, 2.0, 4.0},
                            {"matchstick_burr_3mm", 7.0, 0.25, 1.5, 2.0},
                            {"round_burr_4mm", 7.0, 0.25, 2.0, 2.5},
                            {"acorn_burr_7_5mm", 10.0, 0.25, 4.0, 4.5}}) {
    CAPTURE(c.name);
    CHECK(std::abs(feed_of(c) - 1.0) < 0.2);
  }
}

}  // namespace
}  // namespace burrhole::test
