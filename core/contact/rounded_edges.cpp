#include "core/contact/rounded_edges.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace burrhole {
namespace {

constexpr double kLeast = 0.02;      // [-] of the radius: a smaller displacement is that of a curved face
constexpr double kThickness = 0.45;  // [-] largest radius over the thickness of the tool
constexpr int kRounds = 60;          // of moves away from faces
constexpr double kSameFace = 0.98;   // [-] cosine: a tangent plane within 11 degrees belongs to the same face
constexpr double kOpposite = -0.5;   // [-] cosine of an opposite face

/// Points by cubes of a grid.
class Neighbours {
 public:
  Neighbours(const PointShell& shell, double edge) : shell_(&shell), edge_(edge) {
    for (std::uint32_t n = 0; n < shell.size(); ++n) cells_[key(cell(shell.positions[n]))].push_back(n);
  }
  template <class Use>
  void each_near(const Vec3& p, const Use& use) const {
    const Vec3i at = cell(p);
    for_each_voxel({at - 1, at + 2}, [&](const Vec3i& c) {
      const auto found = cells_.find(key(c));
      if (found == cells_.end()) return;
      for (const std::uint32_t n : found->second)
        if (glm::length(shell_->positions[n] - p) < edge_) use(n);
    });
  }

 private:
  [[nodiscard]] Vec3i cell(const Vec3& p) const noexcept { return floor_int(p / edge_); }
  [[nodiscard]] static std::uint64_t key(const Vec3i& c) noexcept {
    const auto part = [](int n) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(n)) & 0x1fffffu; };
    return part(c.x) | part(c.y) << 21 | part(c.z) << 42;
  }
  const PointShell* shell_;
  double edge_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace

std::vector<Vec3> rounded_edges(const PointShell& shell, double radius) {
  std::vector<Vec3> out(shell.size(), Vec3(0.0));
  // Faces within the ball's reach, and as far as points of a shell may be apart.
  const Neighbours neighbours(shell, 4.0 * radius);
  std::vector<std::uint32_t> faces;
  for (std::size_t n = 0; n < shell.size(); ++n) {
    if (shell.cutting[n] == 0) continue;
    const Vec3 &p = shell.positions[n], &normal = shell.inward_normals[n];
    double ball = radius;
    faces.clear();
    neighbours.each_near(p, [&](std::uint32_t m) {
      const Vec3 &q = shell.positions[m], &face = shell.inward_normals[m];
      const double inside = glm::dot(p - q, face);
      if (shell.cutting[m] == 0 || glm::dot(face, normal) > kSameFace || inside < -kLeast * radius) return;  // also faces of a hollow
      if (glm::dot(face, normal) < kOpposite) ball = std::min(ball, kThickness * inside);
      faces.push_back(m);
    });
    if (faces.empty() || !(ball > 0.0)) continue;
    Vec3 centre = p + ball * normal;
    for (int round = 0; round < kRounds; ++round) {
      double worst = 0.0;
      Vec3 away(0.0);
      for (const std::uint32_t m : faces) {
        const double missing = ball - glm::dot(centre - shell.positions[m], shell.inward_normals[m]);
        if (missing > worst) worst = missing, away = shell.inward_normals[m];
      }
      if (worst < 1e-3 * ball) break;
      centre += worst * away;
    }
    const Vec3 back = p - centre;
    const double length = glm::length(back);
    if (length > (1.0 + kLeast) * ball) out[n] = centre + back * (ball / length) - p;
  }
  return out;
}

}  // namespace burrhole
