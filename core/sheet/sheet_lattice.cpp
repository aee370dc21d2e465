#include "core/sheet/sheet_lattice.h"

#include <cmath>

namespace burrhole {
namespace {

const double kHeight = std::sqrt(0.75);  // of a triangle of edge 1
// Steps of lattice coordinates (i, j) to the six neighbours; a place is (i + j / 2, kHeight j) spacings.
constexpr int kSteps[6][2] = {{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}};

}  // namespace

double SheetLattice::area() const noexcept { return kHeight * spacing_ * spacing_; }

std::uint32_t SheetLattice::node_at(int i, int j) const noexcept {
  if (std::abs(i) > reach_ || std::abs(j) > reach_) return kNoNode;
  return index_[static_cast<std::size_t>(j + reach_) * static_cast<std::size_t>(2 * reach_ + 1) + static_cast<std::size_t>(i + reach_)];
}

Result<SheetLattice> SheetLattice::create(double radius, double spacing, const std::function<bool(double, double)>& has) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, std::string("sheet: ") + why, {}}; };
  if (!(radius > 0.0) || !(spacing > 0.0) || !std::isfinite(radius) || !(radius >= 2.0 * spacing))
    return refuse("the radius must be at least two spacings, and both above 0");
  if (3.7 * (radius / spacing + 1.0) * (radius / spacing + 1.0) > static_cast<double>(kMostNodes)) return refuse("too many nodes");
  SheetLattice out;
  out.spacing_ = spacing;
  out.reach_ = static_cast<int>(radius / spacing / kHeight) + 1;
  const auto side = static_cast<std::size_t>(2 * out.reach_ + 1);
  out.index_.assign(side * side, kNoNode);
  std::vector<std::array<int, 2>> places;
  for (int j = -out.reach_; j <= out.reach_; ++j)
    for (int i = -out.reach_; i <= out.reach_; ++i) {
      const double x = spacing * (i + 0.5 * j), y = spacing * kHeight * j;
      if (std::hypot(x, y) > radius * (1.0 + 1e-12) || (has && !has(x, y))) continue;
      out.index_[static_cast<std::size_t>(j + out.reach_) * side + static_cast<std::size_t>(i + out.reach_)] =
          static_cast<std::uint32_t>(places.size());
      places.push_back({i, j});
      out.x_.push_back(x);
      out.y_.push_back(y);
    }
  bool free = false;
  out.edge_of_.resize(places.size());
  for (std::uint32_t n = 0; n < places.size(); ++n) {
    Neighbours beside{};
    bool rim = false;
    for (std::size_t k = 0; k < 6; ++k) {
      beside[k] = out.node_at(places[n][0] + kSteps[k][0], places[n][1] + kSteps[k][1]);
      rim = rim || beside[k] == kNoNode;
    }
    out.neighbours_.push_back(beside);
    out.rim_.push_back(rim ? 1 : 0);
    free = free || !rim;
  }
  for (std::uint32_t n = 0; n < places.size(); ++n)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t other = out.neighbours_[n][k];
      if (other == kNoNode) continue;
      out.edge_of_[n][k] = out.edge_of_[other][k + 3] = static_cast<std::uint32_t>(out.edges_.size());
      out.edges_.push_back({n, other});
    }
  if (!free) return refuse("no node has all its neighbours");
  return out;
}

std::uint32_t SheetLattice::edge(std::uint32_t a, std::uint32_t b) const noexcept {
  for (std::size_t k = 0; k < 6; ++k)
    if (neighbours_[a][k] == b) return edge_of_[a][k];
  return kNoNode;
}

std::optional<SheetLattice::Place> SheetLattice::find(double x, double y) const noexcept {
  const double v = y / (kHeight * spacing_), u = x / spacing_ - 0.5 * v;
  if (!(std::abs(u) < reach_ + 1.0) || !(std::abs(v) < reach_ + 1.0)) return std::nullopt;
  const int i = floor_int(u), j = floor_int(v);
  const double s = u - i, t = v - j;
  Place out;
  if (s + t <= 1.0)
    out = {{node_at(i, j), node_at(i + 1, j), node_at(i, j + 1)}, {1.0 - s - t, s, t}};
  else
    out = {{node_at(i + 1, j + 1), node_at(i, j + 1), node_at(i + 1, j)}, {s + t - 1.0, 1.0 - s, 1.0 - t}};
  for (const std::uint32_t node : out.nodes)
    if (node == kNoNode) return std::nullopt;
  return out;
}

}  // namespace burrhole
