#include "core/tool/buried_cutters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace burrhole {
namespace {

constexpr double kCells = 96.0;  // [-] along the largest side of a region

bool is_passive(const RegionSpec& region) { return region.erosion.base <= 0.0; }

/// What is at a point of a bit.
struct Found {
  std::optional<std::size_t> passive;  ///< the first passive region there
  bool cuts = false;                   ///< another cutting region is there
};

Found found_at(const ToolSpec& spec, std::size_t self, const Vec3& p) {
  Found out;
  for (std::size_t n = 0; n < spec.regions.size(); ++n) {
    if (n == self || !spec.regions[n].solid.contains(p)) continue;
    if (!is_passive(spec.regions[n]))
      out.cuts = true;
    else if (!out.passive)
      out.passive = n;
  }
  return out;
}

/// Faces of cells on the surface of a region.
struct Faces {
  std::size_t all = 0, covered = 0;
  std::vector<std::size_t> by;  ///< covered faces by region
};

void count_cell(const ToolSpec& spec, std::size_t self, const Vec3& p, double cell, Faces& out) {
  const Solid& solid = spec.regions[self].solid;
  for (std::size_t face = 0; face < 6; ++face) {
    Vec3 q = p;
    q[static_cast<int>(face / 2)] += face % 2 == 0 ? -cell : cell;
    if (solid.contains(q)) continue;
    const Found front = found_at(spec, self, q);
    if (!front.passive && front.cuts) continue;
    const auto owner = spec.region_at(p);
    const bool owned = owner && is_passive(spec.regions[*owner]);
    ++out.all;
    if (!owned && !front.passive) continue;
    ++out.covered;
    ++out.by[owned ? *owner : *front.passive];
  }
}

Faces count_faces(const ToolSpec& spec, std::size_t self) {
  const Solid& solid = spec.regions[self].solid;
  const Bounds box = solid.bounds();
  const Vec3 size = box.hi - box.lo;
  const double cell = std::max({size.x, size.y, size.z}) / kCells;
  Faces out;
  out.by.resize(spec.regions.size());
  const Vec3i count(glm::ceil(size / cell));
  for_each_voxel({Vec3i(0), count}, [&](const Vec3i& v) {
    const Vec3 p = box.lo + (Vec3(v) + 0.5) * cell;
    if (solid.contains(p)) count_cell(spec, self, p, cell, out);
  });
  return out;
}

}  // namespace

std::vector<BuriedCutter> find_buried_cutters(const ToolSpec& spec) {
  std::vector<BuriedCutter> out;
  if (std::ranges::none_of(spec.regions, is_passive)) return out;
  for (std::size_t n = 0; n < spec.regions.size(); ++n) {
    if (is_passive(spec.regions[n])) continue;
    const Faces faces = count_faces(spec, n);
    const double share = faces.all > 0 ? static_cast<double>(faces.covered) / static_cast<double>(faces.all) : 0.0;
    if (share < kBuried) continue;
    const auto most = static_cast<std::size_t>(std::ranges::max_element(faces.by) - faces.by.begin());
    out.push_back({spec.regions[n].name, spec.regions[most].name, share});
  }
  return out;
}

std::string buried_text(const BuriedCutter& cutter) {
  return fmt::format(
      "the cutting region \"{}\" lies inside the passive region \"{}\", {:.0f} % of its surface: what is covered meets no bone and cuts "
      "nothing; let the cutter stand out, or shorten the body",
      cutter.region, cutter.body, 100.0 * cutter.share);
}

}  // namespace burrhole
