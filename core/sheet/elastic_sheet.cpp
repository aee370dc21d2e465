#include "core/sheet/elastic_sheet.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

constexpr double kPoisson2 = 1.0 / 9.0;  // square of the lattice's ratio
constexpr double kHalf = 0.5;            // [-] of a node's cell on the rim that counts for bending: the mirror has the rest

double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += glm::dot(a[n], b[n]);
  return sum;
}

}  // namespace

ElasticSheet::ElasticSheet(const SheetConfig& config, SheetLattice lattice)
    : config_(config),
      lattice_(std::move(lattice)),
      edge_stiffness_(std::sqrt(0.75) * config.modulus * config.thickness),
      // D A (2 / (3 s^2))^2, for the sum of the differences to the neighbours
      bending_(config.modulus * config.thickness * config.thickness * config.thickness / (12.0 * (1.0 - kPoisson2)) * lattice_.area() *
               4.0 / (9.0 * lattice_.spacing() * lattice_.spacing() * lattice_.spacing() * lattice_.spacing())) {}

Result<ElasticSheet> ElasticSheet::create(const SheetConfig& config, SheetLattice lattice, std::span<const double> height) {
  const auto is = [](double value, bool zero_too) { return std::isfinite(value) && (value > 0.0 || (zero_too && value == 0.0)); };
  const bool fits = is(config.modulus, false) && is(config.thickness, false) && is(config.strain_limit, false) &&
                    is(config.support, true) && is(config.resistance, false) && is(config.adhesion, true) &&
                    is(config.adhesion_way, false) && is(config.bone_stiffness, true) && is(config.tool_stiffness, false) &&
                    is(config.tension, true);
  if (!fits || height.size() != lattice.nodes())
    return Error{ErrorCode::out_of_range, "sheet: a value of its config is out of range, or a node has no height", {}};
  ElasticSheet out(config, std::move(lattice));
  const SheetLattice& grid = out.lattice_;
  const std::size_t nodes = grid.nodes();
  for (std::size_t n = 0; n < nodes; ++n) out.rest_.emplace_back(grid.x(n), grid.y(n), height[n]);
  out.x_ = out.before_ = out.rest_;
  for (std::uint32_t n = 0; n < nodes; ++n)
    if (grid.on_rim(n)) out.rim_.push_back(n);
  out.assemble_bending();
  for (const SheetEdge& edge : grid.edges())
    out.length_.push_back(glm::length(out.rest_[edge.a] - out.rest_[edge.b]) / (1.0 + config.tension));
  out.broken_.assign(grid.edges().size(), 0);
  out.edge_curve_.resize(grid.edges().size());
  out.sticks_.assign(nodes, 0);
  out.under_bone_.assign(nodes, 0);
  out.held_.assign(nodes, 1);
  out.queue_.reserve(nodes);
  out.all_.resize(nodes);
  out.up_.resize(nodes);
  out.diagonal_.resize(nodes);
  for (Field* field : {&out.gradient_, &out.direction_, &out.trial_, &out.residual_, &out.shift_, &out.moved_, &out.give_})
    field->assign(nodes, Vec3(0.0));
  return out;
}

void ElasticSheet::cover(std::size_t node, SheetCover cover) noexcept {
  const bool bone = cover == SheetCover::bone;
  // At the start the sheet sticks to the bone above it.
  if (iterations_ == 0)
    sticks_[node] = bone ? 1 : 0;
  else if (!bone)
    sticks_[node] = 0;
  under_bone_[node] = bone ? 1 : 0;
}

std::size_t ElasticSheet::bytes() const noexcept {
  return lattice_.nodes() * (13 * sizeof(Vec3) + sizeof(SheetBlock) + 64) + lattice_.edges().size() * (sizeof(SheetBlock) + 32) +
         solver_->bytes();
}

double ElasticSheet::height_at(const SheetLattice::Place& place, const Field& x) const noexcept {
  double out = 0.0;
  for (std::size_t k = 0; k < 3; ++k) out += place.weights[k] * x[place.nodes[k]].z;
  return out;
}

std::uint32_t ElasticSheet::beside(std::size_t node, std::size_t k) const noexcept {
  const SheetLattice::Neighbours& all = lattice_.neighbours(node);
  return all[k] != SheetLattice::kNoNode ? all[k] : all[(k + 3) % 6];
}

/// The energy is a sum over nodes of squares of g_n . u, g_n the sum of the differences to the neighbours: the matrix is the sum of the products
/// g_n g_n^T. Displacements on the rim are 0, so it needs only the free nodes.
void ElasticSheet::assemble_bending() {
  const std::size_t nodes = lattice_.nodes();
  std::vector<std::vector<std::pair<std::uint32_t, double>>> rows(nodes);
  const auto add = [&](std::uint32_t row, std::uint32_t column, double value) {
    if (lattice_.on_rim(row) || lattice_.on_rim(column)) return;
    const auto at = std::ranges::find(rows[row], column, &std::pair<std::uint32_t, double>::first);
    if (at == rows[row].end())
      rows[row].emplace_back(column, value);
    else
      at->second += value;
  };
  for (std::uint32_t n = 0; n < nodes; ++n) {
    std::array<std::pair<std::uint32_t, double>, 7> g{std::pair{n, 0.0}};
    std::size_t size = 1;
    for (std::size_t k = 0; k < 6; ++k)
      if (const std::uint32_t other = beside(n, k); other != SheetLattice::kNoNode) {
        g[size++] = {other, 1.0};
        g[0].second -= 1.0;
      }
    const double weight = bending_ * (lattice_.on_rim(n) ? kHalf : 1.0);
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t j = 0; j < size; ++j) add(g[i].first, g[j].first, weight * g[i].second * g[j].second);
  }
  SheetRows bend;
  bend.first.push_back(0);
  for (const auto& row : rows) {
    for (const auto& [column, value] : row) {
      bend.column.push_back(column);
      bend.value.push_back(value);
    }
    bend.first.push_back(static_cast<std::uint32_t>(bend.column.size()));
  }
  solver_.emplace(lattice_, std::move(bend));
}

Vec3 ElasticSheet::bending_at(const Field& u, std::size_t node) const noexcept {
  double x = 0.0, y = 0.0, z = 0.0;
  const SheetRows& bend = solver_->bending();
  for (std::uint32_t k = bend.first[node]; k < bend.first[node + 1]; ++k) {
    const double value = bend.value[k];
    const Vec3& v = u[bend.column[k]];
    x += value * v.x;
    y += value * v.y;
    z += value * v.z;
  }
  return {x, y, z};
}

void ElasticSheet::hold_rim(Field& out) const noexcept {
  for (const std::uint32_t n : rim_) out[n] = Vec3(0.0);
}

double ElasticSheet::energy(const Field& x) noexcept {
  const double area = lattice_.area();
  double sum = 0.0;
  for (std::size_t n = 0; n < x.size(); ++n) shift_[n] = x[n] - rest_[n];
  for (std::size_t e = 0; e < length_.size(); ++e) {
    if (broken_[e] != 0) continue;
    const SheetEdge& edge = lattice_.edges()[e];
    const double longer = glm::length(x[edge.a] - x[edge.b]) - length_[e];
    sum += 0.5 * edge_stiffness_ * longer * longer;
  }
  for (std::size_t n = 0; n < x.size(); ++n) {
    const Vec3& u = shift_[n];
    sum += 0.5 * glm::dot(u, bending_at(shift_, n)) + 0.5 * area * config_.support * u.z * u.z;
    if (sticks_[n] != 0) sum += 0.5 * area * config_.adhesion / config_.adhesion_way * glm::dot(u, u);
    if (under_bone_[n] != 0 && u.z > 0.0) sum += 0.5 * area * config_.bone_stiffness * u.z * u.z;
  }
  for (const Pressed& point : pressed_) {
    const double depth = std::max(0.0, height_at(point.place, x) - point.z);
    sum += 0.5 * config_.tool_stiffness * depth * depth;
  }
  return sum;
}

double ElasticSheet::merit(const Field& x, double per_dt, double pressure) noexcept {
  const double area = lattice_.area();
  double sum = energy(x);
  for (std::size_t n = 0; n < x.size(); ++n) {
    const Vec3 moved = x[n] - before_[n];
    sum += 0.5 * area * per_dt * glm::dot(moved, moved) - pressure * area * (x[n].z - rest_[n].z);
  }
  return sum;
}

/// @returns the largest force [N] of the loads: of the tool, or of the pressure on all nodes.
double ElasticSheet::slope(const Field& x, double per_dt, double pressure, Field& out) noexcept {
  const double area = lattice_.area();
  Field& u = shift_;
  for (std::size_t n = 0; n < x.size(); ++n) {
    u[n] = x[n] - rest_[n];
    out[n] = area * per_dt * (x[n] - before_[n]);
  }
  for (std::size_t n = 0; n < x.size(); ++n) {
    out[n] += bending_at(u, n);
    out[n].z += area * (config_.support * u[n].z - pressure);
    if (sticks_[n] != 0) out[n] += area * config_.adhesion / config_.adhesion_way * u[n];
    if (under_bone_[n] != 0 && u[n].z > 0.0) out[n].z += area * config_.bone_stiffness * u[n].z;
  }
  for (std::size_t e = 0; e < length_.size(); ++e) {
    if (broken_[e] != 0) continue;
    const SheetEdge& edge = lattice_.edges()[e];
    const Vec3 along = x[edge.a] - x[edge.b];
    const double length = glm::length(along);
    if (length == 0.0) continue;
    const Vec3 pull = edge_stiffness_ * (length - length_[e]) / length * along;
    out[edge.a] += pull;
    out[edge.b] -= pull;
  }
  double pushed = 0.0;
  for (const Pressed& point : pressed_) {
    const double depth = height_at(point.place, x) - point.z;
    if (depth <= 0.0) continue;
    pushed += config_.tool_stiffness * depth;
    for (std::size_t k = 0; k < 3; ++k) out[point.place.nodes[k]].z += config_.tool_stiffness * depth * point.place.weights[k];
  }
  hold_rim(out);
  return std::max(pushed, std::abs(pressure) * area * std::sqrt(static_cast<double>(x.size())));
}

void ElasticSheet::curve(const Field& x, double per_dt) {
  const double area = lattice_.area();
  for (std::size_t n = 0; n < x.size(); ++n) {
    all_[n] = area * per_dt;
    up_[n] = area * config_.support;
    if (sticks_[n] != 0) all_[n] += area * config_.adhesion / config_.adhesion_way;
    if (under_bone_[n] != 0 && x[n].z > rest_[n].z) up_[n] += area * config_.bone_stiffness;
  }
  for (std::size_t e = 0; e < length_.size(); ++e) {
    edge_curve_[e] = {};
    if (broken_[e] != 0) continue;
    const SheetEdge& edge = lattice_.edges()[e];
    const Vec3 along = x[edge.a] - x[edge.b];
    const double length = glm::length(along);
    if (length == 0.0) continue;
    const Vec3 unit = along / length;
    // Across a shortened edge the second derivative is below 0; without it the sum stays convex.
    const double across = std::max(0.0, 1.0 - length_[e] / length), both = edge_stiffness_ * across;
    const Vec3 part = edge_stiffness_ * (1.0 - across) * unit;
    edge_curve_[e] = {both + part.x * unit.x, part.x * unit.y, part.x * unit.z,
                      both + part.y * unit.y, part.y * unit.z, both + part.z * unit.z};
  }
  for (const Pressed& point : pressed_) {
    if (height_at(point.place, x) <= point.z) continue;
    // c_p w_i (sum of w_j u_j) = c_p w_i u_i - sum of c_p w_i w_j (u_i - u_j), as the weights add up to 1.
    const auto& w = point.place.weights;
    for (std::size_t k = 0; k < 3; ++k) {
      up_[point.place.nodes[k]] += config_.tool_stiffness * w[k];
      edge_curve_[point.edges[k]].zz -= config_.tool_stiffness * w[(k + 1) % 3] * w[(k + 2) % 3];
    }
  }
  invert_diagonal();
}

void ElasticSheet::invert_diagonal() noexcept {
  const SheetRows& bend = solver_->bending();
  for (std::size_t n = 0; n < diagonal_.size(); ++n) {
    double bent = 0.0;
    for (std::uint32_t k = bend.first[n]; k < bend.first[n + 1]; ++k)
      if (bend.column[k] == n) bent = bend.value[k];
    const double all = all_[n] + bent;
    diagonal_[n] = {all, 0.0, 0.0, all, 0.0, all + up_[n]};
  }
  for (std::size_t e = 0; e < length_.size(); ++e) {
    const SheetBlock& m = edge_curve_[e];
    for (const std::uint32_t n : {lattice_.edges()[e].a, lattice_.edges()[e].b}) {
      SheetBlock& d = diagonal_[n];
      d = {d.xx + m.xx, d.xy + m.xy, d.xz + m.xz, d.yy + m.yy, d.yz + m.yz, d.zz + m.zz};
    }
  }
  for (SheetBlock& d : diagonal_) {
    const double xx = d.yy * d.zz - d.yz * d.yz, xy = d.xz * d.yz - d.xy * d.zz, xz = d.xy * d.yz - d.xz * d.yy;
    const double scale = 1.0 / (d.xx * xx + d.xy * xy + d.xz * xz);
    d = {scale * xx,
         scale * xy,
         scale * xz,
         scale * (d.xx * d.zz - d.xz * d.xz),
         scale * (d.xy * d.xz - d.xx * d.yz),
         scale * (d.xx * d.yy - d.xy * d.xy)};
  }
}

void ElasticSheet::solve(const Field& right, Field& out, double tolerance) {
  (void)solver_->solve({.all = all_, .up = up_, .edges = edge_curve_, .diagonal = diagonal_}, right, out, residual_, tolerance);
}

void ElasticSheet::measure() {
  state_.force = tool_force();
  state_.indentation = lowest();
  state_.strain = largest_strain();
  state_.bulge = 0.0;
  for (std::size_t n = 0; n < x_.size(); ++n) state_.bulge = std::max(state_.bulge, x_[n].z - rest_[n].z);
  state_.energy = energy(x_);
  state_.stiffness = 0.0;
  if (!(state_.force > 0.0)) return;
  // The tool moves by -1 along z: its points press harder by c_p, and the sheet gives way without resistance of what is beside it.
  curve(x_, 1e-6 * config_.resistance);
  std::ranges::fill(gradient_, Vec3(0.0));
  double held = 0.0;
  const auto touches = [this](const Pressed& point) { return height_at(point.place, x_) > point.z; };
  for (const Pressed& point : pressed_) {
    if (!touches(point)) continue;
    held += config_.tool_stiffness;
    for (std::size_t k = 0; k < 3; ++k) gradient_[point.place.nodes[k]].z -= config_.tool_stiffness * point.place.weights[k];
  }
  hold_rim(gradient_);
  solve(gradient_, give_, 1e-3);
  // b . x + r . x, r = b - A x what is left: its error is the square of that of x, whatever x started from.
  held -= dot(gradient_, give_) + dot(residual_, give_);
  state_.stiffness = std::max(0.0, held);
}

}  // namespace burrhole
