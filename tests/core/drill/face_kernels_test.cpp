// The kernels of the receding face against plain loops, at every SIMD level.
#include "core/drill/face_kernels.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "core/base/random.h"
#include "core/base/simd.h"
#include "core/tool/field_sampler.h"

using namespace burrhole;

namespace {

constexpr float kEdge = 0.25e-3f, kFollow = 3.5f, kFree = 2.0f, kKnown = 3.4f;  // [m]; [voxel edges]
constexpr float kNone = std::numeric_limits<float>::max();

/// A ball of 2 mm over a table of half a voxel, with factors that fall with the height.
CuttingField ball(bool revolved) {
  CuttingField field;
  field.pitch = 0.125e-3;
  field.margin = 1e-3;
  field.revolved = revolved;
  const int across = revolved ? 25 : 49;
  field.dims = Vec3i(across, revolved ? 1 : across, 49);
  field.origin = Vec3(revolved ? 0.0 : -3e-3, revolved ? 0.0 : -3e-3, -3e-3);
  for_each_voxel({Vec3i(0), field.dims}, [&](const Vec3i& v) {
    const Vec3 p = field.origin + field.pitch * Vec3(v);
    field.distance.push_back(static_cast<float>(glm::length(p) - 2e-3));
    field.factor.push_back(static_cast<float>(0.1 + 10.0 * p.z));
  });
  return field;
}

FaceTool tool_of(const CuttingField& field) {
  const auto u = static_cast<float>(2.0 / std::sqrt(1.09));  // nodes per voxel edge
  return {.field = field_job(field),
          .edge = kEdge,
          .along = {0.3f * u, 0.0f, u},
          .follow = kFollow,
          .free = kFree,
          .known = kKnown,
          .normal_from = {1.0f, 0.2f, 0.0f, 0.0f, 1.0f, 0.0f, 0.1f, 0.0f, 1.0f}};
}

/// Nodes round the ball, with lists as a search leaves them.
FaceNodes nodes_round(const CuttingField& field, std::size_t count) {
  const FieldSampler sampler(field);
  FaceNodes nodes;
  nodes.make_room(count);
  const Vec3f middle(-field.origin / field.pitch);
  for (std::uint64_t n = 0; nodes.count < count; ++n) {
    const auto by = [&](std::uint64_t counter) { return static_cast<float>(uniform11(3, 8 * n + counter)); };
    const Vec3f p = middle + 20.0f * Vec3f(by(0), by(1), by(2));
    const float d = sampler.distance(p) / kEdge, cut = 3.0f * by(3);
    if (d + cut >= 0.0f) continue;
    const std::size_t to = nodes.count++;
    nodes.at[to] = static_cast<std::uint32_t>(n % 1000);
    nodes.inside[to] = static_cast<std::uint32_t>(n % kBlockVoxels);
    nodes.x[to] = p.x, nodes.y[to] = p.y, nodes.z[to] = p.z;
    nodes.tool[to] = d, nodes.cut[to] = cut, nodes.base[to] = 3.0f * by(4);
    nodes.wear[to] = 0.2f + 0.1f * by(5), nodes.behind[to] = by(6) > 0.0f ? 2.0f * by(6) : 0.0f, nodes.rest[to] = 1e-4f * by(7);
  }
  return nodes;
}

void at_every_level(const std::function<void()>& check) {
  for (const SimdLevel level : simd_levels()) {
    CAPTURE(std::string(name_of(level)));
    REQUIRE(choose_simd(name_of(level)).ok());
    check();
  }
  REQUIRE(choose_simd("auto").ok());
}

Vec3f place_of(const FaceNodes& nodes, std::size_t n) { return {nodes.x[n], nodes.y[n], nodes.z[n]}; }

/// A block of random bone and faces, seen from a ball that passes through it.
struct BlockCase {
  CutSurface::Block block;
  std::array<float, kBlockVoxels> occupancy{}, remaining{};
  BlockSearch search;

  BlockCase(const CuttingField& field, std::uint64_t seed) {
    for (std::size_t n = 0; n < kBlockVoxels; ++n) {
      const auto by = [&](std::uint64_t counter) { return static_cast<float>(uniform11(seed, 8 * n + counter)); };
      occupancy[n] = by(0) > 0.0f ? 1.0f : 0.0f;
      remaining[n] = by(1) > -0.5f ? 1.0f : 0.0f;
      block.cut[n] = by(2) > 0.9f ? -CutSurface::kUnset : by(2) > 0.8f ? -3.5f : 3.0f * by(3);
      block.base[n] = by(4);
    }
    const Vec3f middle(-field.origin / field.pitch);
    const auto place = [&](std::size_t axis) { return middle[axis] - 8.0f + 18.0f * static_cast<float>(uniform11(seed, 5000 + axis)); };
    search = {.first = {place(0), place(1), place(2)},
              .step_i = {1.9f, 0.1f, -0.2f},
              .step_j = {-0.1f, 2.0f, 0.1f},
              .step_k = {0.2f, -0.1f, 1.9f},
              .occupancy = occupancy.data(),
              .remaining = remaining.data(),
              .row = kBlockEdge,
              .slab = kBlockEdge * kBlockEdge,
              .at = 77,
              .window_row = 100,
              .window_slab = 5000,
              .base = block.base.data(),
              .cut = block.cut.data(),
              .parts = static_cast<std::uint32_t>(uniform01(seed, 6000) * 256.0),
              .lo = {1, 0, 2},
              .hi = {8, 7, 8}};
  }
};

/// The definition, voxel by voxel.
void plain_search(const FaceTool& tool, const CuttingField& field, const BlockSearch& b, FaceNodes& nodes, BlockFound& found) {
  const FieldSampler sampler(field);
  found.nearest.fill(kNone), found.room.fill(kNone);
  found.lacking_count = 0;
  for_each_voxel({{b.lo[0], b.lo[1], b.lo[2]}, {b.hi[0], b.hi[1], b.hi[2]}}, [&](const Vec3i& v) {
    const auto part = static_cast<std::size_t>(v.x / 4 + 2 * (v.y / 4) + 4 * (v.z / 4)), n = CutSurface::Block::place(v);
    if ((b.parts >> part & 1u) == 0) return;
    const bool bone = b.occupancy[n] > 0.0f && b.remaining[n] > 0.0f;
    const float cut = b.cut[n];
    if (cut > tool.free && !bone) return;
    Vec3f p;
    for (std::size_t c = 0; c < 3; ++c) {
      const float start = b.first[c] + static_cast<float>(v.y) * b.step_j[c] + static_cast<float>(v.z) * b.step_k[c];
      p[c] = start + static_cast<float>(v.x) * b.step_i[c];
    }
    const float d = sampler.distance(p) / tool.edge;
    found.nearest[part] = std::min(found.nearest[part], d);
    if (d > tool.follow) {
      found.room[part] = std::min(found.room[part], d - tool.follow);
      return;
    }
    if (cut <= -tool.known) {
      found.lacking[found.lacking_count] = static_cast<std::uint32_t>(n);
      found.lacking_tool[found.lacking_count++] = d;
      return;
    }
    found.room[part] = std::min(found.room[part], std::max(0.0f, d + cut));
    if (d + cut >= 0.0f) return;
    const std::size_t to = nodes.count++;
    nodes.at[to] = b.at + static_cast<std::uint32_t>(v.x) + b.window_row * static_cast<std::uint32_t>(v.y) +
                   b.window_slab * static_cast<std::uint32_t>(v.z);
    nodes.inside[to] = static_cast<std::uint32_t>(n);
    nodes.x[to] = p.x, nodes.y[to] = p.y, nodes.z[to] = p.z;
    nodes.tool[to] = d, nodes.cut[to] = cut, nodes.base[to] = b.base[n];
  });
}

}  // namespace

TEST_CASE("face kernels: a search finds the nodes, rooms and lacking nodes that a plain loop finds") {
  for (const bool revolved : {false, true}) {
    const CuttingField field = ball(revolved);
    const FaceTool tool = tool_of(field);
    std::size_t nodes_seen = 0, lacking_seen = 0;
    at_every_level([&] {
      for (std::uint64_t seed = 1; seed < 40; ++seed) {
        const BlockCase one(field, seed);
        FaceNodes plain, fast;
        plain.make_room(kBlockVoxels), fast.make_room(kBlockVoxels);
        static BlockFound expected, found;
        plain_search(tool, field, one.search, plain, expected);
        search_block(tool, one.search, fast, found);
        REQUIRE(fast.count == plain.count);
        bool same = found.nearest == expected.nearest && found.room == expected.room && found.lacking_count == expected.lacking_count;
        for (std::size_t n = 0; n < plain.count; ++n)
          same = same && fast.at[n] == plain.at[n] && fast.inside[n] == plain.inside[n] && place_of(fast, n) == place_of(plain, n) &&
                 fast.tool[n] == plain.tool[n] && fast.cut[n] == plain.cut[n] && fast.base[n] == plain.base[n];
        for (std::size_t n = 0; n < expected.lacking_count; ++n)
          same = same && found.lacking[n] == expected.lacking[n] && found.lacking_tool[n] == expected.lacking_tool[n];
        CHECK(same);
        nodes_seen += plain.count, lacking_seen += expected.lacking_count;
      }
    });
    CHECK(nodes_seen > 500);
    CHECK(lacking_seen > 100);
  }
}

TEST_CASE("face kernels: wear is factor over hardness, and the share 1 - exp(-turns wear) within 1e-6 of itself") {
  for (const bool revolved : {false, true}) {
    const CuttingField field = ball(revolved);
    const FaceTool tool = tool_of(field);
    const FieldSampler sampler(field);
    std::vector<float> hardness;
    for (std::uint64_t n = 0; n < 1000; ++n) hardness.push_back(static_cast<float>(uniform01(5, n)));
    FaceNodes nodes = nodes_round(field, 501);
    std::vector<float> shares(nodes.x.size());
    at_every_level([&] {
      find_wear(tool, hardness.data(), 0.1f, nodes);
      for (std::size_t n = 0; n < nodes.count; ++n)
        REQUIRE(nodes.wear[n] == sampler.factor(place_of(nodes, n)) / std::max(hardness[nodes.at[n]], 0.1f));
      for (const float turns : {1e-6f, 0.3f, 10.0f, 1e3f}) {
        find_shares(nodes, turns, shares.data());
        for (std::size_t n = 0; n < nodes.count; ++n) {
          const double exact = -std::expm1(-static_cast<double>(turns * nodes.wear[n]));
          REQUIRE(std::abs(static_cast<double>(shares[n]) - exact) <= 1e-6 * exact);
        }
      }
    });
  }
}

TEST_CASE("face kernels: a lag that settles leads to the face; no lag is missed where the tool is straight above") {
  const CuttingField field = ball(true);
  const FaceTool tool = tool_of(field);
  const FieldSampler sampler(field);
  FaceNodes nodes = nodes_round(field, 777);
  std::vector<float> behind, rest;
  at_every_level([&] {
    find_lags(tool, 0.8f, 20.0f, nodes);
    std::size_t settled = 0;
    for (std::size_t n = 0; n < nodes.count; ++n) {
      if (nodes.behind[n] == 0.0f) continue;
      ++settled;
      const Vec3f there = place_of(nodes, n) - nodes.behind[n] * Vec3f(tool.along[0], tool.along[1], tool.along[2]);
      const float missing = -nodes.cut[n] - sampler.distance(there) / kEdge;
      REQUIRE(std::abs(missing) <= 1e-4f);
      REQUIRE(nodes.rest[n] == missing);
    }
    CHECK(settled > nodes.count / 2);
    // The same lags at every level.
    if (behind.empty()) behind = nodes.behind, rest = nodes.rest;
    CHECK(std::memcmp(behind.data(), nodes.behind.data(), nodes.count * sizeof(float)) == 0);
    CHECK(std::memcmp(rest.data(), nodes.rest.data(), nodes.count * sizeof(float)) == 0);
  });
}

TEST_CASE("face kernels: a face recedes by its share along the normal, or follows the tool where that is further") {
  for (const bool revolved : {false, true}) {
    const CuttingField field = ball(revolved);
    const FaceTool tool = tool_of(field);
    const FieldSampler sampler(field);
    const FaceNodes nodes = nodes_round(field, 333);
    std::vector<float> shares(nodes.x.size(), 0.25f), after(nodes.x.size()), back(nodes.x.size());
    at_every_level([&] {
      recede_nodes(tool, nodes, shares.data(), after.data(), back.data());
      std::size_t followed = 0;
      for (std::size_t n = 0; n < nodes.count; ++n) {
        const float most = -nodes.tool[n], by = (1.0f - shares[n]) * nodes.behind[n];
        const Vec3f there = place_of(nodes, n) - by * Vec3f(tool.along[0], tool.along[1], tool.along[2]);
        const float normal = std::clamp(nodes.cut[n] + shares[n] * (most - nodes.cut[n]), nodes.cut[n], most);
        const float along = std::min(-sampler.distance(there) / kEdge - nodes.rest[n], most);
        const bool follows = nodes.behind[n] > 0.0f && along > normal;
        followed += follows ? 1 : 0;
        REQUIRE(after[n] == (follows ? along : normal));
        REQUIRE(back[n] == (follows ? by : 0.0f));
      }
      CHECK(followed > 10);
      CHECK(followed < nodes.count);
    });
  }
}

TEST_CASE("face kernels: distances are rounded to steps within the band, and normals to the tool's gradient in the bone frame") {
  const CuttingField field = ball(true);
  const FaceTool tool = tool_of(field);
  const FieldSampler sampler(field);
  const FaceNodes nodes = nodes_round(field, 101);
  std::vector<std::int16_t> steps(nodes.x.size());
  std::array<std::vector<std::int16_t>, 3> normals;
  for (auto& list : normals) list.resize(nodes.x.size());
  at_every_level([&] {
    quantise_distances(nodes.cut.data(), nodes.base.data(), nodes.count, steps.data());
    find_normals(tool, {nodes.count, nodes.x.data(), nodes.y.data(), nodes.z.data()},
                 {normals[0].data(), normals[1].data(), normals[2].data()});
    for (std::size_t n = 0; n < nodes.count; ++n) {
      REQUIRE(steps[n] == std::lrint(std::clamp(std::max(nodes.cut[n], nodes.base[n]), -3.5f, 3.5f) * 4096.0f));
      Vec3 slope(0.0);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Vec3f step(0.0f);
        step[axis] = 1.0f;
        slope[axis] = static_cast<double>(sampler.distance(place_of(nodes, n) + step) - sampler.distance(place_of(nodes, n) - step));
      }
      const Vec3 normal = -glm::normalize(Vec3(slope.x + 0.2 * slope.y, slope.y, 0.1 * slope.x + slope.z));
      for (std::size_t axis = 0; axis < 3; ++axis)  // a few roundings of floats, and half a step
        REQUIRE(std::abs(normals[axis][n] - 32767.0 * normal[axis]) < 1.0);
    }
  });
}
