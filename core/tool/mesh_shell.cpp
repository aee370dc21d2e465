#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/tool/mesh_tool.h"

// Even sampling of any surface; own derivation. Candidates are the corners of all triangles, which are split at the middle of their longest
// edge until no edge is longer than h = 0.2 pitch. In a triangle with edges up to h every point is within h / sqrt(3) of a corner (worst
// case: the centre of an equilateral triangle), so the candidates cover the surface to 0.116 pitch. Samples are chosen from them in two
// passes, from the tip upwards: first at least 0.85 pitch apart, which gives a nearly hexagonal pattern on smooth surfaces; then every
// candidate without a sample within 0.59 pitch. So every point of the surface has a sample within (0.116 + 0.59) pitch < pitch / sqrt(2).
// (0.85 was found by trial: a sphere takes 1.45 samples per pitch^2, and 1.8 with 0.72 or 1.0.) A sample covers a candidate only if their
// normals agree to within 84 degrees (cosine 0.1). This separates the two sides of a thin wall and the faces of a right-angled edge.

namespace burrhole {
namespace {

constexpr double kCandidateEdge = 0.2;
constexpr double kFirstSpacing = 0.85;
constexpr double kSecondSpacing = 0.59;
constexpr double kSameSide = 0.1;
constexpr std::size_t kMaxCandidates = 16'000'000;

struct Candidate {
  Vec3 p;
  std::uint32_t triangle;
};

using Corners = std::array<Vec3, 3>;

Corners corners_of(const SurfaceMesh& mesh, std::size_t triangle) {
  const auto at = [&](std::size_t n) { return mesh.positions[mesh.indices[3 * triangle + n]]; };
  return {at(0), at(1), at(2)};
}

/// Splits a triangle until its edges are at most h and adds the new points.
void split(const Corners& t, double h, std::uint32_t triangle, std::vector<Candidate>& out) {
  std::size_t longest = 0;
  double length = 0.0;
  for (std::size_t n = 0; n < 3; ++n) {
    const double edge = glm::distance(t[n], t[(n + 1) % 3]);
    if (edge > length) {
      length = edge;
      longest = n;
    }
  }
  if (length <= h || out.size() > kMaxCandidates) return;
  const Vec3 &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
  const Vec3 middle = 0.5 * (a + b);
  out.push_back({middle, triangle});
  split({a, middle, c}, h, triangle, out);
  split({middle, b, c}, h, triangle, out);
}

std::vector<Candidate> make_candidates(const SurfaceMesh& mesh, const std::vector<Vec3>& normals, double h) {
  std::vector<Candidate> out;
  for (std::uint32_t t = 0; t < normals.size() && out.size() <= kMaxCandidates; ++t) {
    if (normals[t] == Vec3(0.0)) continue;  // zero area: its neighbours contain these points
    const Corners corners = corners_of(mesh, t);
    for (const Vec3& p : corners) out.push_back({p, t});
    split(corners, h, t, out);
  }
  std::sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
    if (a.p.z != b.p.z) return a.p.z < b.p.z;
    if (a.p.y != b.p.y) return a.p.y < b.p.y;
    return a.p.x != b.p.x ? a.p.x < b.p.x : a.triangle < b.triangle;
  });
  return out;
}

std::vector<Vec3> outward_normals(const SurfaceMesh& mesh) {
  std::vector<Vec3> normals;
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const Corners c = corners_of(mesh, t);
    const Vec3 area = glm::cross(c[1] - c[0], c[2] - c[0]);
    const double length = glm::length(area);
    normals.push_back(length > 0.0 ? area / length : Vec3(0.0));
  }
  return normals;
}

/// Samples chosen so far, in a hash grid with cells as wide as the largest query radius.
class Taken {
 public:
  Taken(double cell, const std::vector<Vec3>& normals) : cell_(cell), normals_(normals) {}

  [[nodiscard]] bool any_within(const Candidate& c, double radius) const {
    const Vec3i home = floor_int(c.p / cell_);
    for (int n = 0; n < 27; ++n) {
      const auto found = cells_.find(key(home + Vec3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1)));
      if (found == cells_.end()) continue;
      for (const Candidate& s : found->second)
        if (glm::distance(s.p, c.p) < radius && glm::dot(normals_[s.triangle], normals_[c.triangle]) > kSameSide) return true;
    }
    return false;
  }
  void add(const Candidate& c) { cells_[key(floor_int(c.p / cell_))].push_back(c); }

 private:
  /// A tool lies within 0.2 m and a cell is at least 9 um wide, so 21 bits per axis suffice.
  [[nodiscard]] static std::uint64_t key(const Vec3i& v) noexcept {
    const auto bits = [](int x) { return static_cast<std::uint64_t>(x + (1 << 20)); };
    return bits(v.x) << 42 | bits(v.y) << 21 | bits(v.z);
  }
  double cell_;
  const std::vector<Vec3>& normals_;
  std::unordered_map<std::uint64_t, std::vector<Candidate>> cells_;
};

Error too_many(const MeshToolSpec& spec) {
  return {ErrorCode::out_of_range,
          fmt::format("a pitch_mm of {:g} makes more than {} shell points: take a larger one", spec.pitch * 1e3, kMaxShellPoints),
          {}};
}

}  // namespace

Result<PointShell> make_mesh_shell(const MeshToolSpec& spec, const SurfaceMesh& mesh) {
  const std::vector<Vec3> normals = outward_normals(mesh);
  const std::vector<Candidate> candidates = make_candidates(mesh, normals, kCandidateEdge * spec.pitch);
  if (candidates.size() > kMaxCandidates) return too_many(spec);
  PointShell shell;
  Taken taken(kFirstSpacing * spec.pitch, normals);
  for (const double spacing : {kFirstSpacing * spec.pitch, kSecondSpacing * spec.pitch})
    for (const Candidate& c : candidates) {
      if (taken.any_within(c, spacing)) continue;
      if (shell.size() == kMaxShellPoints) return too_many(spec);
      taken.add(c);
      shell.positions.push_back(c.p);
      shell.inward_normals.push_back(-normals[c.triangle]);
      shell.cutting.push_back(spec.cuts_at(c.p.z) ? 1 : 0);
    }
  return shell;
}

}  // namespace burrhole
