#include "app/effect/dura_rent.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace burrhole {
namespace {

constexpr double kReach = 3.0;  // [kBlur] beyond which a torn triangle counts no more
// A corner of a triangle with a node farther away than this has no torn triangle in its reach.
constexpr double kNear = kReach * DuraRent::kBlur + 1.0;  // [spacings]
constexpr int kFills = 40;                                // sweeps over the nodes that are lost, to smooth a first guess

}  // namespace

DuraRent::DuraRent(const SheetLattice& lattice, const std::vector<std::uint8_t>& broken)
    : lattice_(&lattice), spacing_(lattice.spacing()), held_(lattice.nodes(), 0), near_(lattice.nodes(), 0) {
  std::vector<std::uint32_t> queue;
  const auto hold = [&](std::uint32_t n) {
    held_[n] = 1;
    queue.push_back(n);
  };
  for (std::uint32_t n = 0; n < held_.size(); ++n)
    if (lattice.on_rim(n)) hold(n);
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const std::uint32_t n = queue[next];
    for (const std::uint32_t m : lattice.neighbours(n))
      if (m != SheetLattice::kNoNode && held_[m] == 0 && broken[lattice.edge(n, m)] == 0) hold(m);
  }
  const auto is_whole = [&](const Nodes& nodes) {
    for (std::size_t k = 0; k < 3; ++k)
      if (held_[nodes[k]] == 0 || broken[lattice.edge(nodes[k], nodes[(k + 1) % 3])] != 0) return false;
    return true;
  };
  for_each_triangle(lattice, [&](const Nodes& nodes) {
    if (is_whole(nodes)) return;
    glm::dvec2 middle(0.0);
    for (const std::uint32_t n : nodes) middle += glm::dvec2(lattice.x(n), lattice.y(n)) / 3.0;
    torn_.push_back(middle);
  });
  std::ranges::sort(torn_, {}, [this](const glm::dvec2& p) { return order(p); });
  if (torn_.empty()) return;
  for (std::uint32_t n = 0; n < near_.size(); ++n) {
    const glm::dvec2 p(lattice.x(n), lattice.y(n));
    for_each_torn(p, [&](const glm::dvec2& middle) {
      near_[n] = glm::length(middle - p) < kNear * spacing_ ? 1 : 0;
      return near_[n] == 0;
    });
  }
}

/// Rows of a height of kNear, and places along each.
std::pair<double, double> DuraRent::order(const glm::dvec2& p) const noexcept { return {std::floor(p.y / (kNear * spacing_)), p.x}; }

/// Calls f for torn triangles in the rows round a point, at least for those within kNear, until it returns false.
template <class F>
void DuraRent::for_each_torn(const glm::dvec2& p, F&& f) const {
  const double reach = kNear * spacing_, row = order(p).first;
  for (const double beside : {row - 1.0, row, row + 1.0}) {
    auto at = std::ranges::lower_bound(torn_, std::pair(beside, p.x - reach), {}, [this](const glm::dvec2& q) { return order(q); });
    for (; at != torn_.end() && order(*at) <= std::pair(beside, p.x + reach); ++at)
      if (!f(*at)) return;
  }
}

DuraRent::Opening DuraRent::at(const glm::dvec2& p) const noexcept {
  const double width = kBlur * spacing_, most = kReach * width * kReach * width;
  // Triangles of area sqrt(3)/4 of the spacing's square: their weights sum to 1 where all are torn.
  const double each = 0.25 * std::numbers::sqrt3 * spacing_ * spacing_ / (2.0 * std::numbers::pi * width * width);
  Opening out;
  for_each_torn(p, [&](const glm::dvec2& middle) {
    const glm::dvec2 way = p - middle;
    const double far = glm::dot(way, way);
    if (far > most) return true;
    const double weight = each * std::exp(-0.5 * far / (width * width));
    out.share += weight;
    out.slope -= weight / (width * width) * way;
    return true;
  });
  return out;
}

void DuraRent::fill_lost(std::vector<Vec3>& moved) const {
  const auto mean = [&](std::uint32_t n, const std::vector<std::uint8_t>& known) {
    Vec3 sum(0.0);
    double count = 0.0;
    for (const std::uint32_t m : lattice_->neighbours(n)) {
      if (m == SheetLattice::kNoNode || known[m] == 0) continue;
      sum += moved[m];
      count += 1.0;
    }
    return sum / count;
  };
  // Ring by ring from what is held, the rim at least, so that the middle of a wide rent does not lag behind.
  std::vector<std::uint32_t> queue;
  std::vector<std::uint8_t> reached = held_, known = held_;
  for (std::uint32_t n = 0; n < held_.size(); ++n)
    if (held_[n] != 0) queue.push_back(n);
  const std::size_t held = queue.size();
  for (std::size_t next = 0; next < queue.size(); ++next)
    for (const std::uint32_t m : lattice_->neighbours(queue[next])) {
      if (m == SheetLattice::kNoNode || reached[m] != 0) continue;
      reached[m] = 1;
      queue.push_back(m);
    }
  const std::span lost = std::span(queue).subspan(held);
  for (const std::uint32_t n : lost) {
    moved[n] = mean(n, known);
    known[n] = 1;
  }
  for (int sweep = 0; sweep < kFills; ++sweep)
    for (const std::uint32_t n : lost) moved[n] = mean(n, known);
}

}  // namespace burrhole
