#include "app/effect/dura_rent.h"

#include <cmath>
#include <numbers>

namespace burrhole {
namespace {

constexpr double kReach = 3.0;  // [kBlur] beyond which a torn triangle counts no more
constexpr int kFills = 40;      // sweeps over the nodes that are lost, more than any rent has across

}  // namespace

DuraRent::DuraRent(const SheetLattice& lattice, const std::vector<std::uint8_t>& broken)
    : lattice_(&lattice), broken_(&broken), spacing_(lattice.spacing()), held_(lattice.nodes(), 0), near_(lattice.nodes(), 0) {
  std::vector<std::uint32_t> queue;
  for (std::uint32_t n = 0; n < held_.size(); ++n)
    if (lattice.on_rim(n)) held_[n] = 1, queue.push_back(n);
  for (std::size_t next = 0; next < queue.size(); ++next)
    for (const std::uint32_t m : lattice.neighbours(queue[next]))
      if (m != SheetLattice::kNoNode && held_[m] == 0 && broken[lattice.edge(queue[next], m)] == 0) held_[m] = 1, queue.push_back(m);
  for_each_triangle(lattice, [&](const Nodes& nodes) {
    if (is_whole(nodes)) return;
    glm::dvec2 middle(0.0);
    for (const std::uint32_t n : nodes) middle += glm::dvec2(lattice.x(n), lattice.y(n)) / 3.0;
    torn_.push_back(middle);
  });
  // A corner of a triangle with a node farther away than this has no torn triangle in its reach.
  const double reach = (kReach * kBlur + 1.0) * spacing_;
  for (std::uint32_t n = 0; n < near_.size(); ++n)
    for (const glm::dvec2& middle : torn_)
      if (glm::length(middle - glm::dvec2(lattice.x(n), lattice.y(n))) < reach) near_[n] = 1;
}

bool DuraRent::is_whole(const Nodes& nodes) const noexcept {
  for (std::size_t k = 0; k < 3; ++k)
    if (held_[nodes[k]] == 0 || (*broken_)[lattice_->edge(nodes[k], nodes[(k + 1) % 3])] != 0) return false;
  return true;
}

DuraRent::Opening DuraRent::at(const glm::dvec2& p) const noexcept {
  const double width = kBlur * spacing_, most = kReach * width * kReach * width;
  // Triangles of area sqrt(3)/4 of the spacing's square: their weights sum to 1 where all are torn.
  const double each = 0.25 * std::numbers::sqrt3 * spacing_ * spacing_ / (2.0 * std::numbers::pi * width * width);
  Opening out;
  for (const glm::dvec2& middle : torn_) {
    const glm::dvec2 way = p - middle;
    const double far = glm::dot(way, way);
    if (far > most) continue;
    const double weight = each * std::exp(-0.5 * far / (width * width));
    out.share += weight;
    out.slope -= weight / (width * width) * way;
  }
  return out;
}

void DuraRent::fill_lost(std::vector<Vec3>& moved) const {
  std::vector<std::uint32_t> lost;
  for (std::uint32_t n = 0; n < held_.size(); ++n)
    if (held_[n] == 0) lost.push_back(n), moved[n] = Vec3(0.0);
  for (int sweep = 0; sweep < kFills; ++sweep)
    for (const std::uint32_t n : lost) {
      Vec3 sum(0.0);
      double count = 0.0;
      for (const std::uint32_t m : lattice_->neighbours(n))
        if (m != SheetLattice::kNoNode) sum += moved[m], count += 1.0;
      moved[n] = sum / count;
    }
}

}  // namespace burrhole
