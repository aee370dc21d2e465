#include "core/sheet/sheet_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace burrhole {
namespace {

constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::min();
constexpr int kReach = 2, kSide = 2 * kReach + 1;  // [steps] of bending
constexpr std::size_t kBackOf[] = {4, 5, 3};       // neighbours whose edges end at a node, in the order of the edges
// Arrays of nodes: bending, edges, inverse blocks, what is diagonal, and fields of three.
constexpr std::size_t kEdges = kBendTerms, kBlocks = kEdges + 18, kAll = kBlocks + 6, kUp = kAll + 1, kFields = kUp + 1;
constexpr std::size_t kFieldCount = 10, kArrays = kFields + 3 * kFieldCount;

/// Distances in numbers to the nodes within two steps, by lattice steps.
using Around = std::array<std::int32_t, static_cast<std::size_t>(kSide) * kSide>;

std::size_t place_of_step(int i, int j) noexcept {
  const int at = (j + kReach) * kSide + i + kReach;
  return static_cast<std::size_t>(at);
}

/// @returns the place in Around of a node seen from another, at most two steps away.
std::size_t step_between(const SheetLattice& lattice, std::uint32_t from, std::uint32_t to) {
  const double height = lattice.area() / lattice.spacing();  // of a row
  const int j = static_cast<int>(std::lround((lattice.y(to) - lattice.y(from)) / height));
  const int i = static_cast<int>(std::lround((lattice.x(to) - lattice.x(from)) / lattice.spacing() - 0.5 * j));
  return place_of_step(i, j);
}

Around around(const SheetLattice& lattice, std::uint32_t n) {
  Around out;
  out.fill(kUnknown);
  const auto note = [&](std::uint32_t other) {
    out[step_between(lattice, n, other)] = static_cast<std::int32_t>(other) - static_cast<std::int32_t>(n);
  };
  note(n);
  for (const std::uint32_t one : lattice.neighbours(n)) {
    if (one == SheetLattice::kNoNode) continue;
    note(one);
    for (const std::uint32_t two : lattice.neighbours(one))
      if (two != SheetLattice::kNoNode) note(two);
  }
  return out;
}

/// Adds what is known to `all`. @returns false, with `all` as it was: the two differ.
bool join(const Around& more, Around& all) {
  for (std::size_t k = 0; k < all.size(); ++k)
    if (more[k] != kUnknown && all[k] != kUnknown && more[k] != all[k]) return false;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (more[k] != kUnknown) all[k] = more[k];
  return true;
}

/// @returns the steps of the terms of bending, in the order in which rows with all of them have them; empty: there is no such row.
std::vector<std::size_t> order_of_terms(const SheetLattice& lattice, const SheetRows& rows) {
  std::vector<std::size_t> out;
  for (std::uint32_t n = 0; n < lattice.nodes(); ++n) {
    if (rows.first[n + 1] - rows.first[n] != kBendTerms) continue;
    for (std::uint32_t k = rows.first[n]; k < rows.first[n + 1]; ++k) out.push_back(step_between(lattice, n, rows.column[k]));
    return out;
  }
  return out;
}

}  // namespace

SheetSolver::SheetSolver(const SheetLattice& lattice, SheetRows bending) : rows_(std::move(bending)), nodes_(lattice.nodes()) {
  const std::vector<std::size_t> terms = order_of_terms(lattice, rows_);
  find_spans(lattice, terms);
  place_rows(lattice, terms);
  free_.assign(nodes_ + kSheetPad, 0);
  for (std::size_t n = 0; n < nodes_; ++n) free_[n] = lattice.on_rim(n) ? 0 : ~std::uint64_t{0};
  for (const SheetEdge& edge : lattice.edges()) {
    std::size_t k = 0;
    while (lattice.neighbours(edge.a)[k] != edge.b) ++k;
    place_.push_back(static_cast<std::size_t>(array(kEdges + 6 * k) - arrays_.data()) + edge.a);
  }
}

void SheetSolver::find_spans(const SheetLattice& lattice, const std::vector<std::size_t>& terms) {
  std::vector<Around> all;
  for (std::uint32_t n = 0; n < nodes_; ++n) {
    const Around here = around(lattice, n);
    const bool beside = n > 0 && lattice.neighbours(n - 1)[0] == n;
    if (beside && join(here, all.back())) {
      ++spans_.back().count;
      continue;
    }
    spans_.push_back({.first = n, .count = 1});
    all.push_back(here);
  }
  std::int32_t least = 0, most = 0;
  for (std::size_t s = 0; s < spans_.size(); ++s) {
    SheetSpan& span = spans_[s];
    const auto set = [&](std::int32_t distance, std::int32_t& to) {
      to = distance == kUnknown ? 0 : distance;
      least = std::min(least, static_cast<std::int32_t>(span.first) + to);
      most = std::max(most, static_cast<std::int32_t>(span.first + span.count) + to);
    };
    for (std::size_t k = 0; k < terms.size(); ++k) set(all[s][terms[k]], span.bend[k]);
    constexpr int kSteps[6][2] = {{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}};
    const auto to = [&](std::size_t k) { return all[s][place_of_step(kSteps[k][0], kSteps[k][1])]; };
    for (std::size_t k = 0; k < 3; ++k) {
      set(to(k), span.onward[k]);
      set(to(kBackOf[k]), span.back[k]);
    }
  }
  lead_ = static_cast<std::size_t>(-least);
  stride_ = lead_ + std::max(nodes_, static_cast<std::size_t>(most)) + kSheetPad;
  arrays_.assign(kArrays * stride_, 0.0);
}

void SheetSolver::place_rows(const SheetLattice& lattice, const std::vector<std::size_t>& terms) {
  for (std::uint32_t n = 0; n < nodes_; ++n) {
    std::array<double, kBendTerms> values{};
    std::size_t next = 0;
    bool odd = false;
    for (std::uint32_t k = rows_.first[n]; k < rows_.first[n + 1] && !odd; ++k) {
      const std::size_t step = step_between(lattice, n, rows_.column[k]);
      while (next < terms.size() && terms[next] != step) ++next;
      odd = next == terms.size();
      if (!odd) values[next++] = rows_.value[k];
    }
    if (odd) odd_.push_back(n);
    for (std::size_t k = 0; k < kBendTerms; ++k) array(k)[n] = odd ? 0.0 : values[k];
  }
}

int SheetSolver::solve(const SheetCurve& curve, std::span<const Vec3> right, std::span<Vec3> out, std::span<Vec3> rest,
                       double tolerance) noexcept {
  const auto blocks = [this](std::size_t which) {
    return SheetBlocks{array(which), array(which + 1), array(which + 2), array(which + 3), array(which + 4), array(which + 5)};
  };
  const auto field = [this](std::size_t n) {
    return SheetField{array(kFields + 3 * n), array(kFields + 3 * n + 1), array(kFields + 3 * n + 2)};
  };
  const auto put = [this](const SheetBlock& one, double* to) {
    for (const double value : {one.xx, one.xy, one.xz, one.yy, one.yz, one.zz}) {
      *to = value;
      to += stride_;
    }
  };
  SheetJob job{.nodes = nodes_,
               .spans = spans_,
               .bend = {},
               .odd = odd_,
               .first = rows_.first.data(),
               .column = rows_.column.data(),
               .value = rows_.value.data(),
               .free = free_.data(),
               .all = array(kAll),
               .up = array(kUp),
               .edges = {blocks(kEdges), blocks(kEdges + 6), blocks(kEdges + 12)},
               .diagonal = blocks(kBlocks),
               .right = field(0),
               .out = field(1),
               .rest = field(2),
               .search = field(3),
               .product = field(4),
               .conditioned = field(5),
               .bent = field(6),
               .pulls = {field(7), field(8), field(9)},
               .tolerance = tolerance,
               .most = kMost};
  for (std::size_t k = 0; k < kBendTerms; ++k) job.bend[k] = array(k);
  std::ranges::copy(curve.all, array(kAll));
  std::ranges::copy(curve.up, array(kUp));
  for (std::size_t e = 0; e < place_.size(); ++e) put(curve.edges[e], arrays_.data() + place_[e]);
  for (std::size_t n = 0; n < nodes_; ++n) {
    put(curve.diagonal[n], array(kBlocks) + n);
    job.right.x[n] = right[n].x;
    job.right.y[n] = right[n].y;
    job.right.z[n] = right[n].z;
    job.out.x[n] = out[n].x;
    job.out.y[n] = out[n].y;
    job.out.z[n] = out[n].z;
  }
  const int steps = conjugate_gradients(job);
  for (std::size_t n = 0; n < nodes_; ++n) {
    out[n] = {job.out.x[n], job.out.y[n], job.out.z[n]};
    rest[n] = {job.rest.x[n], job.rest.y[n], job.rest.z[n]};
  }
  return steps;
}

std::size_t SheetSolver::bytes() const noexcept {
  return (arrays_.size() + rows_.value.size()) * sizeof(double) + spans_.size() * sizeof(SheetSpan) + free_.size() * sizeof(std::uint64_t) +
         place_.size() * sizeof(std::size_t) + (odd_.size() + rows_.first.size() + rows_.column.size()) * sizeof(std::uint32_t);
}

}  // namespace burrhole
