// The patch of triangles: its search against all triangles and winding numbers, its updates against a patch made anew.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/random.h"
#include "core/contact/nearest_triangle.h"
#include "core/mesh/mesh_patch.h"
#include "core/voxel/contact_window.h"
#include "tests/core/drill/drill_cases.h"
#include "tests/core/drill/subvoxel_cases.h"
#include "tests/core/mesh/mesh_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// A master window over a bone of the mesh tests.
MasterWindow window_of(const MeshBone& bone) {
  MasterWindow out;
  out.box = bone.box;
  out.density = bone.density;
  return out;
}

/// The same bone in a box that is `by` voxels wider on each side.
MeshBone padded(const MeshBone& bone, int by) {
  MeshBone out{bone.box.grown(by), {}};
  out.density.assign(out.box.count(), 0.0f);
  for_each_voxel(bone.box, [&](const Vec3i& v) { out.density[out.box.offset_of(v)] = bone.density[bone.box.offset_of(v)]; });
  return out;
}

double plain_distance2(const PatchTriangle& t, const Vec3& p) {
  // By the definition: the projection if it is inside, otherwise the nearest of the three edges.
  const std::array<Vec3, 3> c{Vec3(t.corners[0]), Vec3(t.corners[1]), Vec3(t.corners[2])};
  const Vec3 n = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
  const Vec3 foot = p - glm::dot(p - c[0], n) * n;
  bool inside = true;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < 3; ++e) {
    const Vec3 &a = c[e], &b = c[(e + 1) % 3];
    inside = inside && glm::dot(glm::cross(b - a, foot - a), n) >= 0.0;
    const double share = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
    const Vec3 off = p - (a + share * (b - a));
    best = std::min(best, glm::dot(off, off));
  }
  return inside ? std::min(best, glm::dot(p - foot, p - foot)) : best;
}

/// Solid angle of all triangles over 4 pi: 1 inside a closed surface, 0 outside (Van Oosterom and Strackee 1983).
double winding(const TrianglePatch& patch, const Vec3& p) {
  double sum = 0.0;
  for (const PatchBlock& block : patch.blocks)
    for (const PatchTriangle& t : block.triangles) {
      const Vec3 a = Vec3(t.corners[0]) - p, b = Vec3(t.corners[1]) - p, c = Vec3(t.corners[2]) - p;
      const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
      sum += std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
    }
  return sum / (2.0 * std::numbers::pi);
}

std::vector<MeshShape> shapes() {
  std::vector<MeshShape> out = small_shapes(3);
  out.push_back({"ball", ramp({20, 20, 20}, [](const Vec3& p) { return glm::length(p - Vec3(9.7, 10.1, 9.9)) - 7.0; })});
  out.push_back({"pit", ramp({24, 24, 16}, [](const Vec3& p) {
                   const double hole = 5.0 - glm::length(Vec3(p.x - 11.6, p.y - 12.1, 0.0));
                   return std::max({p.z - 12.2, 2.1 - p.z, 2.0 - p.x, p.x - 21.0, 2.0 - p.y, p.y - 21.0, std::min(hole, p.z - 6.0)});
                 })});
  return out;
}

const Affine kSheared{Mat3(0.4e-3, 0.05e-3, 0.0, 0.0, 0.5e-3, 0.0, 0.02e-3, 0.0, 0.7e-3), Vec3(0.1, -0.2, 0.05)};
const Affine kMirrored{Mat3(-0.5e-3, 0.0, 0.0, 0.0, 0.5e-3, 0.0, 0.0, 0.0, 0.5e-3), Vec3(0.0)};

}  // namespace

TEST_CASE("patch: the search finds the nearest of all triangles, with and without a bound, in any frame of voxels") {
  for (const Affine& frame : {Affine{Mat3(0.5e-3), Vec3(0.0)}, kSheared, kMirrored})
    for (const MeshShape& shape : shapes()) {
      CAPTURE(shape.name);
      const MeshBone bone = padded(shape.bone, 4);
      MeshPatch made(frame);
      made.rebuild(window_of(bone));
      const TrianglePatch& patch = made.patch();
      for (std::uint64_t n = 0; n < 120; ++n) {
        const Vec3 voxel = Vec3(bone.box.size()) * Vec3(uniform01(1, 3 * n), uniform01(1, 3 * n + 1), uniform01(1, 3 * n + 2));
        const Vec3 p = frame.linear * voxel;
        double least = std::numeric_limits<double>::infinity();
        for (const PatchBlock& block : patch.blocks)
          for (const PatchTriangle& t : block.triangles) least = std::min(least, plain_distance2(t, p));
        const NearestTriangle found = find_nearest(patch, p, std::numeric_limits<double>::infinity());
        REQUIRE((found.triangle != nullptr) == std::isfinite(least));
        if (found.triangle == nullptr) continue;
        // Rounding of coordinates of a centimetre: 2e-18 m, on both ways.
        CHECK(std::abs(std::sqrt(found.distance2) - std::sqrt(least)) <= 1e-9 * std::sqrt(least) + 1e-10);
        const NearestTriangle again = find_nearest(patch, p, found.distance2);
        CHECK(again.triangle == found.triangle);
        CHECK(again.inside == found.inside);
        CHECK(find_nearest(patch, p, 0.9 * found.distance2 - 1e-18).triangle == nullptr);
        // Below its own plane by no more than the distance.
        CHECK(std::abs(found.depth) <= std::sqrt(least) * (1.0 + 1e-6) + 1e-9);
      }
    }
}

TEST_CASE("patch: the side of the nearest place is that of the winding number, on edges, vertices, walls and handles") {
  std::size_t inside = 0, outside = 0;
  for (const Affine& frame : {Affine{Mat3(0.5e-3), Vec3(0.0)}, kSheared, kMirrored})
    for (const MeshShape& shape : shapes()) {
      CAPTURE(shape.name);
      if (shape.name.starts_with("noise")) continue;  // its offsets turn triangles over
      const MeshBone bone = padded(shape.bone, 4);
      MeshPatch made(frame);
      made.rebuild(window_of(bone));
      for (std::uint64_t n = 0; n < 150; ++n) {
        const Vec3 voxel =
            Vec3(4.0) + Vec3(shape.bone.box.size()) * Vec3(uniform01(2, 3 * n), uniform01(2, 3 * n + 1), uniform01(2, 3 * n + 2));
        const Vec3 p = frame.linear * voxel;
        const double turns = winding(made.patch(), p);
        const NearestTriangle found = find_nearest(made.patch(), p, std::numeric_limits<double>::infinity());
        if (found.triangle == nullptr) continue;
        if (found.distance2 < 1e-16) continue;                        // on the surface, to 10 nm
        if (std::abs(turns - std::round(turns)) > 0.01) FAIL(turns);  // not closed
        if (turns > 1.5) continue;                                    // parts that overlap
        CAPTURE(voxel.x);
        CAPTURE(voxel.y);
        CAPTURE(voxel.z);
        CHECK(found.inside == (turns > 0.5));
        (turns > 0.5 ? inside : outside) += 1;
      }
    }
  CHECK(inside > 500);
  CHECK(outside > 1000);
}

TEST_CASE("patch: a point of a block that is not near bone is outside") {
  for (const MeshShape& shape : shapes()) {
    CAPTURE(shape.name);
    const MeshBone bone = padded(shape.bone, 8);
    MeshPatch made({Mat3(0.5e-3), Vec3(0.0)});
    made.rebuild(window_of(bone));
    const TrianglePatch& patch = made.patch();
    std::size_t far = 0;
    for (std::uint64_t n = 0; n < 200; ++n) {
      const Vec3 voxel = Vec3(bone.box.size() - 1) * Vec3(uniform01(3, 3 * n), uniform01(3, 3 * n + 1), uniform01(3, 3 * n + 2));
      const Vec3i block = patch.block_of(patch.box.lo + voxel_of(voxel));
      if (patch.blocks[patch.block_box().offset_of(block)].near_bone) continue;
      ++far;
      CHECK(std::abs(winding(patch, 0.5e-3 * voxel)) < 0.01);
    }
    CHECK(far > 20);
  }
}

TEST_CASE("patch: after each step of a drilling, and after undo, it is the patch made anew, and each published copy is that patch") {
  for (const bool ball : {true, false})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      CAPTURE(ball);
      CAPTURE(seed);
      const SolidCase one{.ball = ball, .radius = 4.0, .way = 9.0, .seed = seed};
      const SweptSolid solid = random_solid(one);
      Voxmap voxmap = block_for(one);
      Erosion erosion = subvoxel_erosion(solid, kAtOnce);
      const ContactFields fields{.density = true, .gradient = false, .words = false, .records = {}, .triangles = make_mesh_patch};
      ContactWindowPublisher publisher(voxmap, fields), lockstep(voxmap, fields, true);
      const VoxelBox whole = voxmap.window().box;
      const auto check = [&] {
        publisher.publish(voxmap);
        lockstep.publish(voxmap);
        MeshPatch anew(voxmap.bone().bone_from_index());
        anew.rebuild(voxmap.window());
        for (const TrianglePatch* copy : {&publisher.exchange().latest().triangles, &lockstep.exchange().latest().triangles}) {
          CHECK(copy->box == voxmap.window().box);
          CHECK(copy->blocks == anew.patch().blocks);
          CHECK(copy->groups == anew.patch().groups);
        }
      };
      check();
      for (int n = 0; n < 6; ++n) {
        drill_step(voxmap, erosion, solid.from, solid.way, n, 6);
        if (n == 3) REQUIRE(voxmap.place_window({whole.lo + Vec3i(1, 0, 2), whole.hi + Vec3i(1, 0, 2)}).ok());
        if (n != 1) check();  // a step that is not published is caught up
      }
      bring_back(voxmap);
      check();
    }
}

TEST_CASE("patch: memory is counted, and the plan of it covers a window full of bone with a drilled hole") {
  const MeshBone slab = ramp({64, 64, 48}, [](const Vec3& p) { return std::max(8.3 - p.z, p.z - 39.2); });
  const MeshBone bone = padded(slab, 3);
  MeshPatch made({Mat3(0.25e-3), Vec3(0.0)});
  made.rebuild(window_of(bone));
  TrianglePatch copy;
  made.bring_up_to_date(copy);
  CHECK(copy.blocks == made.patch().blocks);
  std::size_t triangles = 0;
  for (const PatchBlock& block : copy.blocks) triangles += block.triangles.size();
  CHECK(copy.bytes() >= triangles * sizeof(PatchTriangle));
  CHECK(made.bytes() > made.mesh().bytes() + copy.bytes());
  const std::size_t planned = mesh_patch_bytes(bone.box.count(), 1), taken = made.bytes() + copy.bytes();
  MESSAGE("planned " << planned << " bytes, taken " << taken);
  CHECK(taken <= planned);
  CHECK(planned <= 3 * taken);
}
