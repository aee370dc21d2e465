#include "core/drill/projected_area.h"

#include <algorithm>

namespace burrhole {

double projected_area(std::span<const Vec3> points, const Vec3& direction, double edge, std::vector<std::uint64_t>& cells) {
  const Quat rotation = glm::conjugate(rotation_from_z(direction));
  cells.clear();
  for (const Vec3& p : points) {
    const Vec3 q = rotation * p;
    const auto cell = [edge](double x) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(floor_int(x / edge + 0.5))); };
    cells.push_back(cell(q.x) << 32 | cell(q.y));
  }
  std::sort(cells.begin(), cells.end());
  return static_cast<double>(std::unique(cells.begin(), cells.end()) - cells.begin()) * edge * edge;
}

}  // namespace burrhole
