#include "app/view/clipped_patch.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

namespace burrhole {
namespace {

constexpr double kNearEnd = 1e-4;  // [-] of an edge: a cut is at least so far from its ends
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class Clip {
 public:
  Clip(const TriangleMesh& mesh, std::span<const double> values, const PatchColor& color, AddedMesh& out)
      : mesh_(mesh), values_(values), color_(color), out_(out), ids_(values.size(), kNone) {}

  void append(const std::array<std::uint32_t, 3>& corners) {
    std::array<std::uint32_t, 4> polygon{};
    std::size_t count = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t a = corners[n], b = corners[(n + 1) % 3];
      if (is_in(a)) polygon[count++] = vertex(a);
      if (is_in(a) != is_in(b)) polygon[count++] = crossing(std::min(a, b), std::max(a, b));
    }
    for (std::size_t n = 2; n < count; ++n) out_.triangles.push_back({polygon[0], polygon[n - 1], polygon[n]});
  }

 private:
  [[nodiscard]] bool is_in(std::uint32_t n) const { return values_[n] >= 0.0; }
  std::uint32_t add(const Vec3f& p, double value) {
    out_.vertices.push_back(p);
    out_.colors.push_back(color_(p, value));
    return static_cast<std::uint32_t>(out_.vertices.size() - 1);
  }
  std::uint32_t vertex(std::uint32_t n) {
    if (ids_[n] == kNone) ids_[n] = add(mesh_.positions[n], values_[n]);
    return ids_[n];
  }
  std::uint32_t crossing(std::uint32_t a, std::uint32_t b) {
    const auto [at, fresh] = crossings_.try_emplace({a, b}, 0);
    if (fresh) {
      const double part = std::clamp(values_[a] / (values_[a] - values_[b]), kNearEnd, 1.0 - kNearEnd);
      at->second = add(glm::mix(mesh_.positions[a], mesh_.positions[b], static_cast<float>(part)), 0.0);
    }
    return at->second;
  }

  const TriangleMesh& mesh_;
  std::span<const double> values_;
  const PatchColor& color_;
  AddedMesh& out_;
  std::vector<std::uint32_t> ids_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> crossings_;
};

}  // namespace

void append_clipped(const TriangleMesh& mesh, std::span<const double> values, const PatchColor& color, AddedMesh& out) {
  Clip clip(mesh, values, color, out);
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) clip.append({mesh.indices[n], mesh.indices[n + 1], mesh.indices[n + 2]});
}

}  // namespace burrhole
