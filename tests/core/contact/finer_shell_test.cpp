// The force of a tool at rest at spin 0 on edges, corners and rims, against a shell and a grid four times finer.
//   Reference  the shell of the tool file with a quarter of its pitch, on a grid of a quarter of the voxel that has the trilinear density of
//              the coarse grid. Its 0.5 surface is the same, so every difference is an error of contact.
//   Shape      A phantom that is sampled at voxel / 4 has another 0.5 surface: its edges are less rounded. The third test computes that
//              difference in closed form.
#include <cstdio>
#include <span>

#include "edge_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr int kFiner = 4;
constexpr double kPressed = 0.4e-3;  // [m] of the hand beyond the first touch: 2 N
constexpr double kAbove = 0.3e-3;    // [m] over the first touch, where it comes from

struct Difference {
  double degrees = 0.0;  ///< between the directions
  double percent = 0.0;  ///< of the magnitude, over the reference's
};
constexpr Difference kBar{0.5, 1.0};

Difference difference(const Vec3& force, const Vec3& reference) {
  return {degrees_between(force, reference), 100.0 * std::abs(glm::length(force) - glm::length(reference)) / glm::length(reference)};
}
Difference larger(const Difference& a, const Difference& b) { return {std::max(a.degrees, b.degrees), std::max(a.percent, b.percent)}; }
bool within(const Difference& a, const Difference& limit) { return a.degrees <= limit.degrees && a.percent <= limit.percent; }

/// Sizes of bone and tool with which a window of 256 fine voxels holds both.
struct Room {
  double edge;   ///< [m] of a voxel
  double width;  ///< [m] of the bone
  double depth;  ///< [m] of the bone below its top
  double tool;   ///< [m] height of the tool above its tip
};
constexpr Room kEighth{0.125e-3, 3e-3, 1.5e-3, 2e-3}, kQuarter{0.25e-3, 6e-3, 3e-3, 2.5e-3}, kHalf{0.5e-3, 8e-3, 4e-3, 4.5e-3};

/// A wedge of 90 degrees, the corner of a block, or the rim of a hole.
Place place_of(const Room& room, const std::string& name, double edge) {
  const bool rim = name == "rim" || name == "small rim";
  const PhantomKind kind = rim ? PhantomKind::pit : name == "corner" ? PhantomKind::block : PhantomKind::wedge;
  const double margin = 2.0 * room.edge;
  Place out{name, edge_spec(kind, edge, Vec3(room.width, room.width, room.depth + margin))};
  out.spec.above = margin;
  out.spec.wedge_angle = 90.0 * kDegree;
  out.spec.block_size = Vec3(0.5 * room.width, 0.5 * room.width, room.depth - margin);
  out.spec.thickness = room.depth + margin;
  out.spec.hole_radius = name == "rim" ? 1.2e-3 : 0.6e-3;
  out.spec.hole_depth = room.depth - margin;
  if (name == "corner") out.site = Vec3(0.25 * room.width, 0.25 * room.width, 0.0);
  return out;
}

/// The trilinear density at the centres of a finer grid. Its trilinear interpolation is that of the coarse grid.
DenseBone finer(const DenseBone& bone) {
  const VoxelBox all{Vec3i(0), bone.dims};
  DenseBone out;
  out.dims = (bone.dims - 1) * kFiner + 1;
  out.bone_from_index = bone.bone_from_index * Affine::scaling(1.0 / kFiner, Vec3(0.0));
  const float hardness = *std::ranges::max_element(bone.hardness);
  for_each_voxel({Vec3i(0), out.dims}, [&](const Vec3i& v) {
    const Vec3 index = Vec3(v) / static_cast<double>(kFiner);
    const double density =
        test::plain_trilinear(index, [&](const Vec3i& at) { return all.contains(at) ? bone.occupancy[all.offset_of(at)] : 0.0f; });
    out.occupancy.push_back(static_cast<float>(density));
    out.hardness.push_back(density > 0.0 ? hardness : 0.0f);
    out.labels.push_back(bone.labels[all.offset_of(voxel_of(index))]);
  });
  return out;
}

/// Bone of one place on the coarse and on the fine grid.
struct Bones {
  std::unique_ptr<ShippedBone> coarse, fine;
  std::vector<Vec3> points;  ///< of the 0.5 surface, world frame
  Bones(const Room& room, const std::string& name) {
    const Place place = place_of(room, name, room.edge);
    const Pose at{Quat(1.0, 0.0, 0.0, 0.0), -place.site};
    const Phantom phantom = phantom_of(place.spec);
    const int margin = (256 / kFiner - phantom.bone.dims.x) / 2 - 1;
    // Records are known to within seven voxels of the window's edge, which are fewer mm on the fine grid.
    coarse = std::make_unique<ShippedBone>(phantom.bone, at, RecordPrecision::bits16, margin + 8);
    fine = std::make_unique<ShippedBone>(finer(phantom.bone), at, RecordPrecision::bits16, margin * kFiner);
    points = surface_points(phantom, phantom.truth.box_lo(), phantom.truth.box_hi(), 2);
    for (Vec3& p : points) p = at * p;
  }
};

/// A bit with its own shell and the finer one.
struct Shells {
  Bit shipped, fine;
  Shells(const std::string& name, double height) : shipped(name, height), fine(name, height, kFiner) {}
};

/// The force on the hand, with the shipped defaults of the tool.
Vec3 rest(const Bit& bit, const ShippedBone& bone, const Quat& turn, const Vec3& touch, bool follows = true) {
  auto tool = ConstrainedTool::create({}, bit.shell, bone.edge(), {.surface = follows ? bit.surface : nullptr});
  REQUIRE(tool.ok());
  const Vec3 force = settled_force(*tool, bone.view(), {turn, touch + Vec3(0.0, 0.0, kAbove)}, Vec3(0.0, 0.0, -(kPressed + kAbove)));
  CHECK(tool->state().flags == 0);
  return force;
}

/// What a case differs by, the largest of its places aside.
struct Measured {
  Difference both;      ///< from the reference
  Difference shell;     ///< from the finer shell on the same grid
  Difference grid;      ///< of the finer shell on the coarse grid from the reference
  Difference points;    ///< of the points of the shell alone from the reference
  double voxels = 0.0;  ///< [voxel] difference of the magnitudes from the reference, over the stiffness of the coupling
};

/// Where the axis of the tool meets the level of the edge. None is on the edge itself, where a pointed tool may rest on either side of it.
constexpr double kAside[2][2] = {{0.13e-3, 0.05e-3}, {0.20e-3, 0.11e-3}};

Measured measure(const Bones& bones, const Shells& bit, double lean) {
  Measured out;
  const Quat turn = leaning(lean * kDegree);
  for (const auto& [x, y] : kAside) {
    const Vec3 touch(x, y, first_touch(bit.shipped.solid, bones.points, turn, Vec3(x, y, 0.0)));
    const Vec3 force = rest(bit.shipped, *bones.coarse, turn, touch), same_grid = rest(bit.fine, *bones.coarse, turn, touch);
    const Vec3 reference = rest(bit.fine, *bones.fine, turn, touch);
    CHECK(glm::length(reference) > 1.0);  // or nothing was touched
    out.both = larger(out.both, difference(force, reference));
    out.shell = larger(out.shell, difference(force, same_grid));
    out.grid = larger(out.grid, difference(same_grid, reference));
    out.points = larger(out.points, difference(rest(bit.shipped, *bones.coarse, turn, touch, false), reference));
    out.voxels = std::max(out.voxels, std::abs(glm::length(force) - glm::length(reference)) / (kStiffness * bones.coarse->edge()));
  }
  return out;
}

struct Case {
  const char* place;
  const char* bit;
  double lean;              ///< [deg]
  Difference both = kBar;   ///< known limit: the measured figure, rounded up, where it exceeds the bar
  Difference shell = kBar;  ///< the same for the shell alone
};

// Known limits. Of 58 cases one is within the bar, which at 2 N and voxels of 0.25 mm is 0.016 voxel. Causes, as far as found:
//   Grid   In a cell with an edge the interpolated records are off by up to 0.15 voxel (second test). The finer shell on the same grid still
//          differs from the reference by up to 21 % and 38 degrees: `grid` in the output.
//   Shell  On edges and corners the normals of records differ from the slopes of their distances, by 10 and by up to 40 degrees. A place that
//          settles by the normals is up to 0.12 voxel less deep than the deepest, which a point of the finer shell is near.
//   Poses  The matchstick burr and the twist drill that lean on the rim of 2.4 mm: normals tilt within a voxel of the rim, and the tool slides
//          into the hole, while the reference rests beside it.
constexpr Case kEighthCases[] = {
    {"edge", "round_burr_2mm", 0, {0.8, 1.9}},
    {"edge", "round_burr_2mm", 30, {4.3, 1.2}, {2.3, 1.2}},
    {"edge", "twist_drill_2_5mm", 0, {0.5, 2.4}, {1.6, 2.0}},
    {"edge", "twist_drill_2_5mm", 30},
    {"corner", "round_burr_2mm", 0, {3.7, 5.2}, {0.7, 1.0}},
    {"corner", "twist_drill_2_5mm", 0, {2.0, 3.5}},
    {"small rim", "round_burr_2mm", 0, {2.4, 2.3}, {1.2, 1.0}},
    {"small rim", "twist_drill_2_5mm", 0, {1.0, 3.2}},
    {"small rim", "twist_drill_2_5mm", 30, {1.2, 1.0}},
};
constexpr Case kQuarterCases[] = {
    {"edge", "round_burr_2mm", 0, {1.8, 4.6}},
    {"edge", "round_burr_2mm", 30, {8.8, 1.2}, {3.0, 1.8}},
    {"edge", "round_burr_4mm", 0, {1.3, 5.4}},
    {"edge", "round_burr_4mm", 30, {3.2, 3.6}, {0.9, 3.8}},
    {"edge", "acorn_burr_7_5mm", 0, {1.5, 5.8}},
    {"edge", "acorn_burr_7_5mm", 30, {1.9, 4.2}, {0.7, 4.1}},
    {"edge", "matchstick_burr_3mm", 0, {0.5, 6.2}},
    {"edge", "matchstick_burr_3mm", 30, {8.3, 2.8}, {5.1, 1.0}},
    {"edge", "twist_drill_2_5mm", 0, {0.6, 4.6}, {1.9, 4.8}},
    {"edge", "twist_drill_2_5mm", 30, {3.8, 1.9}},
    {"corner", "round_burr_2mm", 0, {7.3, 6.8}},
    {"corner", "round_burr_4mm", 0, {4.2, 7.7}, {0.5, 1.4}},
    {"corner", "round_burr_4mm", 30, {2.8, 4.5}, {2.2, 5.1}},
    {"corner", "acorn_burr_7_5mm", 0, {3.0, 8.8}, {0.8, 2.5}},
    {"corner", "acorn_burr_7_5mm", 30, {3.5, 5.5}, {5.0, 10.3}},
    {"corner", "matchstick_burr_3mm", 0, {0.5, 7.6}, {0.5, 1.5}},
    {"corner", "matchstick_burr_3mm", 30, {6.2, 10.2}, {5.0, 8.0}},
    {"corner", "twist_drill_2_5mm", 0, {1.6, 8.1}, {1.5, 3.4}},
    {"rim", "round_burr_4mm", 0, {1.6, 4.5}, {4.7, 1.0}},
    {"rim", "round_burr_4mm", 30, {6.3, 5.2}, {2.0, 3.4}},
    {"rim", "acorn_burr_7_5mm", 0, {6.0, 4.3}, {3.6, 1.0}},
    {"rim", "acorn_burr_7_5mm", 30, {1.9, 1.0}, {1.0, 1.0}},
    {"rim", "matchstick_burr_3mm", 0, {12.2, 2.3}, {1.2, 1.0}},
    {"rim", "matchstick_burr_3mm", 30, {37.8, 4.3}, {1.3, 1.0}},
    {"rim", "twist_drill_2_5mm", 0, {4.2, 4.1}, {1.6, 1.7}},
    {"rim", "twist_drill_2_5mm", 30, {27.4, 7.3}, {6.6, 1.9}},
    {"small rim", "round_burr_2mm", 0, {7.5, 5.3}, {3.6, 1.0}},
    {"small rim", "round_burr_2mm", 30, {9.5, 1.5}, {2.8, 2.2}},
    {"small rim", "round_burr_4mm", 0, {5.4, 9.8}, {5.6, 5.6}},
    {"small rim", "acorn_burr_7_5mm", 0, {5.0, 7.9}, {1.9, 1.6}},
    {"small rim", "twist_drill_2_5mm", 0, {4.7, 7.3}, {1.8, 1.0}},
};
constexpr Case kHalfCases[] = {
    {"edge", "round_burr_4mm", 0, {2.4, 10.7}},
    {"edge", "round_burr_4mm", 30, {5.1, 6.4}, {4.2, 6.7}},
    {"edge", "acorn_burr_7_5mm", 0, {1.7, 11.1}},
    {"edge", "acorn_burr_7_5mm", 30, {2.1, 6.6}, {1.8, 6.2}},
    {"edge", "matchstick_burr_3mm", 0, {0.5, 11.7}},
    {"edge", "matchstick_burr_3mm", 30, {0.7, 6.9}, {1.2, 5.8}},
    {"corner", "round_burr_4mm", 0, {4.6, 22.4}, {0.7, 5.5}},
    {"corner", "round_burr_4mm", 30, {5.6, 12.0}, {2.4, 4.9}},
    {"corner", "acorn_burr_7_5mm", 0, {5.4, 16.3}, {2.5, 4.4}},
    {"corner", "acorn_burr_7_5mm", 30, {3.1, 10.8}, {2.3, 4.1}},
    {"corner", "matchstick_burr_3mm", 0, {0.5, 17.3}, {0.5, 2.4}},
    {"corner", "matchstick_burr_3mm", 30, {5.1, 11.4}, {1.8, 4.8}},
    {"rim", "round_burr_4mm", 0, {11.6, 10.0}, {3.3, 1.0}},
    {"rim", "round_burr_4mm", 30, {11.6, 3.2}},
    {"rim", "acorn_burr_7_5mm", 0, {8.0, 15.0}, {12.1, 3.1}},
    {"rim", "acorn_burr_7_5mm", 30, {2.5, 1.0}},
    {"rim", "matchstick_burr_3mm", 0, {21.6, 6.2}, {9.7, 1.2}},
    {"rim", "matchstick_burr_3mm", 30, {9.0, 2.9}, {0.8, 1.0}},
};

/// A limit that is not needed is an error as well.
void check(const Difference& measured, const Difference& limit) {
  CHECK(measured.degrees <= limit.degrees);
  CHECK(measured.percent <= limit.percent);
  if (limit.degrees > kBar.degrees) CHECK(measured.degrees > kBar.degrees);
  if (limit.percent > kBar.percent) CHECK(measured.percent > kBar.percent);
}

/// @returns how many cases exceed their limits with the points of the shell alone.
std::size_t run(const Room& room, std::span<const Case> cases) {
  std::size_t exceeding = 0;
  std::unique_ptr<Bones> bones;
  std::string place;
  for (const Case& c : cases) {
    if (place != c.place) {
      place = c.place;
      bones = std::make_unique<Bones>(room, place);
    }
    CAPTURE(place);
    CAPTURE(std::string(c.bit));
    CAPTURE(c.lean);
    const Measured m = measure(*bones, Shells(c.bit, room.tool), c.lean);
    std::printf(
        "  %.3f mm, %-9s %-19s %2.0f deg: %5.2f deg %5.2f %% %5.3f voxel; shell %5.2f %5.2f, grid %5.2f %5.2f, points %5.2f %5.2f\n",
        room.edge * 1e3, c.place, c.bit, c.lean, m.both.degrees, m.both.percent, m.voxels, m.shell.degrees, m.shell.percent, m.grid.degrees,
        m.grid.percent, m.points.degrees, m.points.percent);
    check(m.both, c.both);
    check(m.shell, c.shell);
    exceeding += within(m.points, c.both) ? 0 : 1;
  }
  return exceeding;
}

/// [voxel] The largest distance that records give at the 0.5 surface near the edge, where it is 0.
double record_error(const ShippedBone& bone, const std::vector<Vec3>& points, const Room& room) {
  const SurfaceView view = bone.view();
  const RecordSampler records(view.records);
  const Affine index_from_world = view.records.bone_from_index.inverse() * Affine::from_pose(view.world_from_bone.inverse());
  double out = 0.0;
  for (const Vec3& p : points) {
    if (glm::length(p) > 0.4 * room.width || p.z < -0.5 * room.depth) continue;  // the ends of bone
    const auto found = records.at(index_from_world * p);
    REQUIRE(found);
    out = std::max(out, std::abs(found->distance));
  }
  return out;
}

}  // namespace

TEST_CASE("surface: at two supports the force differs from that of a shell and a grid four times finer by no more than is listed") {
  // Sabotage: with the points of the shell alone nearly all exceed these limits.
  CHECK(run(kEighth, kEighthCases) >= 8);
  CHECK(run(kQuarter, kQuarterCases) >= 28);
  CHECK(run(kHalf, kHalfCases) >= 17);
}

TEST_CASE("surface: records at the 0.5 surface of an edge, a corner and a rim are off by up to 0.15 voxel of their grid") {
  for (const char* name : {"edge", "corner", "rim", "small rim"}) {
    const Bones bones(kQuarter, name);
    const double coarse = record_error(*bones.coarse, bones.points, kQuarter), fine = record_error(*bones.fine, bones.points, kQuarter);
    std::printf("  %.3f mm, %-9s: %.3f voxel, on the finer grid %.3f of its voxels\n", kQuarter.edge * 1e3, name, coarse, fine);
    CHECK(coarse > 0.08);  // or it is not the cause
    CHECK(coarse < 0.15);
    CHECK(fine < 0.15);
  }
}

TEST_CASE("surface: from a phantom sampled at a quarter of the voxel the force differs further by the rounding of its edge") {
  // Of a wedge of 90 degrees that is symmetric to the grid the voxels beside the crest have a distance of 0 half a voxel below it, and a
  // density of 0.5. So the 0.5 surface ends half a voxel below the crest, 0.375 voxel deeper than with a quarter of the voxel.
  for (const Room& room : {kQuarter, kHalf}) {
    const Bones bones(room, "edge");
    const Phantom sampled = phantom_of(place_of(room, "edge", room.edge / kFiner).spec);
    const ShippedBone shape(sampled.bone, {}, RecordPrecision::bits16, (256 - sampled.bone.dims.x) / 2);
    const Bit bit("matchstick_burr_3mm", room.tool, kFiner);
    const Quat turn = leaning(0.0);
    const Vec3 aside(kAside[0][0], kAside[0][1], 0.0), touch(aside.x, aside.y, first_touch(bit.solid, bones.points, turn, aside));
    const double same = rest(bit, *bones.fine, turn, touch).z, finer_shape = rest(bit, shape, turn, touch).z;
    // A flat end on a level crest: the stiffness times the depth. The reference is off by 0.1 of its voxels.
    const double allowed = kStiffness * 0.1 * room.edge / kFiner;
    CHECK(touch.z == doctest::Approx(-0.5 * room.edge).epsilon(0.01));
    CHECK(std::abs(same - kStiffness * kPressed) < allowed);
    CHECK(std::abs(finer_shape - same - kStiffness * 0.375 * room.edge) < allowed);
    std::printf("  %.3f mm: %.3f N, phantom of voxel / 4 %.3f N\n", room.edge * 1e3, same, finer_shape);
  }
}
