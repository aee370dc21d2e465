#include "core/sheet/sheet_solver.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "core/base/random.h"
#include "core/base/simd.h"

namespace burrhole::test {
namespace {

/// A sheet's equations of random numbers: A is positive, as blocks of edges and what is diagonal are.
struct Equations {
  SheetLattice lattice;
  SheetRows rows;
  std::vector<double> all, up;
  std::vector<SheetBlock> edges, diagonal;
  std::vector<Vec3> right, start;
};

/// A matrix with the columns of bending: in each row those of free nodes within two steps, in the order in which a sum over the neighbours'
/// neighbours meets them.
SheetRows random_rows(const SheetLattice& lattice, std::uint64_t seed) {
  SheetRows out;
  std::uint64_t drawn = 0;
  out.first.push_back(0);
  for (std::uint32_t n = 0; n < lattice.nodes(); ++n) {
    const std::uint32_t first = out.first.back();
    const auto add = [&](std::uint32_t column) {
      if (lattice.on_rim(n) || lattice.on_rim(column)) return;
      if (std::find(out.column.begin() + first, out.column.end(), column) != out.column.end()) return;
      out.column.push_back(column);
      out.value.push_back(column == n ? 40.0 : uniform11(seed, drawn++));
    };
    for (const std::uint32_t one : lattice.neighbours(n)) {
      if (one == SheetLattice::kNoNode) continue;
      add(one);
      for (const std::uint32_t two : lattice.neighbours(one))
        if (two != SheetLattice::kNoNode) add(two);
    }
    out.first.push_back(static_cast<std::uint32_t>(out.column.size()));
  }
  return out;
}

Equations random_equations(SheetLattice lattice, std::uint64_t seed) {
  Equations out{lattice, random_rows(lattice, seed), {}, {}, {}, {}, {}, {}};
  std::uint64_t drawn = 1'000'000;
  const auto any = [&] { return uniform11(seed, drawn++); };
  for (std::size_t n = 0; n < lattice.nodes(); ++n) {
    out.all.push_back(std::exp(4.0 * any()));
    out.up.push_back(std::exp(4.0 * any()));
    const double x = 1.0 + 0.5 * any(), y = 1.0 + 0.5 * any(), z = 1.0 + 0.5 * any();
    out.diagonal.push_back({0.02 * x, 0.005 * any(), 0.005 * any(), 0.02 * y, 0.005 * any(), 0.02 * z});
    const bool free = !lattice.on_rim(n);
    out.right.push_back(free ? Vec3(any(), any(), any()) : Vec3(0.0));
    out.start.push_back(free ? 0.1 * Vec3(any(), any(), any()) : Vec3(0.0));
  }
  for (std::size_t e = 0; e < lattice.edges().size(); ++e) {
    const Vec3 u(any(), any(), any());
    const double broken = any() < -0.8 ? 0.0 : 1.0, b = 10.0 * broken;
    out.edges.push_back({b * u.x * u.x, b * u.x * u.y, b * u.x * u.z, b * u.y * u.y, b * u.y * u.z, b * u.z * u.z});
  }
  return out;
}

/// Twin: node by node and edge by edge.
std::vector<Vec3> times(const Equations& a, const std::vector<Vec3>& in) {
  std::vector<Vec3> out;
  for (std::size_t n = 0; n < in.size(); ++n) {
    Vec3 bent(0.0);
    for (std::uint32_t k = a.rows.first[n]; k < a.rows.first[n + 1]; ++k) bent += a.rows.value[k] * in[a.rows.column[k]];
    out.push_back(a.all[n] * in[n] + bent);
    out[n].z += a.up[n] * in[n].z;
  }
  for (std::size_t e = 0; e < a.edges.size();) {
    const std::uint32_t first = a.lattice.edges()[e].a;
    Vec3 sum(0.0);
    for (; e < a.edges.size() && a.lattice.edges()[e].a == first; ++e) {
      const Vec3 pull = a.edges[e] * (in[first] - in[a.lattice.edges()[e].b]);
      sum += pull;
      out[a.lattice.edges()[e].b] -= pull;
    }
    out[first] += sum;
  }
  for (std::size_t n = 0; n < in.size(); ++n)
    if (a.lattice.on_rim(n)) out[n] = Vec3(0.0);
  return out;
}

struct Solution {
  std::vector<Vec3> out, rest;
  int steps = 0;
};

double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += glm::dot(a[n], b[n]);
  return sum;
}

Solution plain(const Equations& a, double tolerance) {
  const auto conditioned = [&](const std::vector<Vec3>& v) {
    std::vector<Vec3> out;
    for (std::size_t n = 0; n < v.size(); ++n) out.push_back(a.diagonal[n] * v[n]);
    return out;
  };
  Solution s{a.start, times(a, a.start), 0};
  for (std::size_t n = 0; n < s.rest.size(); ++n) s.rest[n] = a.right[n] - s.rest[n];
  std::vector<Vec3> search = conditioned(s.rest);
  double size = dot(s.rest, search);
  const double enough = dot(a.right, conditioned(a.right)) * tolerance * tolerance;
  for (; s.steps < SheetSolver::kMost && size > enough && size > 0.0; ++s.steps) {
    const std::vector<Vec3> product = times(a, search);
    const double way = size / dot(search, product);
    for (std::size_t n = 0; n < search.size(); ++n) {
      s.out[n] += way * search[n];
      s.rest[n] -= way * product[n];
    }
    const std::vector<Vec3> next = conditioned(s.rest);
    const double turn = dot(s.rest, next) / size;
    size = dot(s.rest, next);
    for (std::size_t n = 0; n < search.size(); ++n) search[n] = next[n] + turn * search[n];
  }
  return s;
}

Solution by_vectors(const Equations& a, double tolerance) {
  SheetSolver solver(a.lattice, a.rows);
  Solution s{a.start, std::vector<Vec3>(a.start.size()), 0};
  // Twice: what the first solution leaves in memory is of no meaning to the second.
  for (int n = 0; n < 2; ++n) {
    s.out = a.start;
    s.steps = solver.solve({.all = a.all, .up = a.up, .edges = a.edges, .diagonal = a.diagonal}, a.right, s.out, s.rest, tolerance);
  }
  return s;
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

struct Shape {
  std::string name;
  double radius;
  bool (*has)(double x, double y);
};

const Shape kShapes[] = {
    {"disc", 12.0, [](double, double) { return true; }},
    {"least", 2.0, [](double, double) { return true; }},
    {"half", 9.3, [](double x, double y) { return x + 0.4 * y < 2.2; }},
    {"with holes", 11.0, [](double x, double y) { return std::hypot(x - 3.0, y + 2.0) > 1.2 && std::hypot(x + 5.0, y) > 0.4; }},
    {"noise", 10.0, [](double x, double y) { return std::fmod(std::abs(std::sin(37.0 * x + 91.0 * y)) * 1e4, 1.0) > 0.04; }},
};

}  // namespace

TEST_CASE("sheet: the equations are solved by vectors in the bits of sums node by node, at every level and on sheets of any shape") {
  std::vector<std::string> levels{"auto"};
  for (const SimdLevel level : simd_levels()) levels.emplace_back(name_of(level));
  for (const Shape& shape : kShapes) {
    CAPTURE(shape.name);
    auto lattice = SheetLattice::create(shape.radius, 1.0, shape.has);
    REQUIRE(lattice);
    const Equations equations = random_equations(std::move(*lattice), 7);
    for (const double tolerance : {0.1, 1e-8}) {
      const Solution expected = plain(equations, tolerance);
      REQUIRE(expected.steps > 1);
      REQUIRE(expected.steps < SheetSolver::kMost);
      for (const std::string& level : levels) {
        CAPTURE(level);
        REQUIRE(choose_simd(level).ok());
        const Solution found = by_vectors(equations, tolerance);
        CHECK(found.steps == expected.steps);
        CHECK(same_bits(found.out, expected.out));
        CHECK(same_bits(found.rest, expected.rest));
      }
    }
    REQUIRE(choose_simd("auto").ok());
    // What is left is what the solution leaves: the method's own account of it, to rounding.
    const Solution found = by_vectors(equations, 1e-8);
    const std::vector<Vec3> product = times(equations, found.out);
    for (std::size_t n = 0; n < product.size(); ++n) CHECK(glm::length(equations.right[n] - product[n] - found.rest[n]) < 1e-10);
  }
}

TEST_CASE("sheet: a term out of order, or one bit of an edge, is noticed by the comparison of bits") {
  auto lattice = SheetLattice::create(12.0, 1.0);
  REQUIRE(lattice);
  const Equations equations = random_equations(std::move(*lattice), 7);
  const Solution expected = plain(equations, 1e-8);
  const std::size_t middle = equations.lattice.nodes() / 2;
  Equations other = equations;
  std::swap(other.rows.column[other.rows.first[middle]], other.rows.column[other.rows.first[middle] + 5]);
  std::swap(other.rows.value[other.rows.first[middle]], other.rows.value[other.rows.first[middle] + 5]);
  CHECK(same_bits(by_vectors(other, 1e-8).out, plain(other, 1e-8).out));  // a row of another order than the rest
  CHECK(!same_bits(by_vectors(other, 1e-8).out, expected.out));
  other = equations;
  const auto whole = std::find_if(other.edges.begin() + static_cast<std::ptrdiff_t>(other.edges.size() / 2), other.edges.end(),
                                  [](const SheetBlock& edge) { return edge.xx > 1.0; });
  whole->xx = std::nextafter(whole->xx, 1e9);
  CHECK(!same_bits(by_vectors(other, 1e-8).out, expected.out));
}

}  // namespace burrhole::test
