#include "core/drill/chip_load.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace burrhole {

CuttingTeeth cutting_teeth(const Tool& tool) {
  const ErosionPoints& points = tool.erosion;
  if (points.size() == 0) return {};
  std::vector<std::pair<long long, long long>> columns;  // of the lattice along the shaft
  columns.reserve(points.size());
  const auto cell = [&](double x) { return static_cast<long long>(std::floor(x / points.pitch)); };
  for (std::size_t n = 0; n < points.size(); ++n)
    if (points.factors[n] > 0.0f) columns.emplace_back(cell(points.positions[n].x), cell(points.positions[n].y));
  std::ranges::sort(columns);
  const auto end = std::ranges::unique(columns).begin();
  const auto count = static_cast<double>(end - columns.begin());
  return {.count = count > 0.0 ? tool.teeth : 0, .area = count * points.pitch * points.pitch};
}

ChipLoad chip_load(const CuttingTeeth& teeth, const ChipInput& step) noexcept {
  ChipLoad out;
  const double passes = step.spin * step.dt * teeth.count;
  if (!(passes > 0.0)) return out;
  out.force = step.tangential / teeth.count;
  out.power = 2.0 * std::numbers::pi * step.spin * step.torque;
  if (!(step.mass > 0.0)) return out;
  out.cuts = true;
  out.volume = step.mass / passes;
  out.thickness = out.volume / teeth.area;
  out.hardness = step.hardness;
  return out;
}

}  // namespace burrhole
