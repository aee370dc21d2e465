#include "app/effect/dura_shell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

#include "app/effect/dura_looks.h"

namespace burrhole {
namespace {

constexpr double kCurved = 0.75;                                   // [-] share of the curvature between nodes: Phong tessellation
constexpr int kParts = 5;                                          // of an edge
constexpr std::size_t kCorners = (kParts + 1) * (kParts + 2) / 2;  // of the parts of a triangle
constexpr double kBump = 50e-6, kBumpWide = 0.7e-3;                // [m] height and width of what breaks the gloss (an assumption)
constexpr double kFray = 0.07, kFrayWide = 0.45e-3;  // [-] of the opening, [m]: how uneven the edge of a rent is (an assumption)
constexpr double kCurl = 0.12e-3, kSwell = 0.12;     // [m], [-] of the thickness: of the edge of a rent (assumptions)
constexpr double kLipFrom = 0.1;                     // [-] opening from which the lip begins
constexpr int kRing = 5;                             // parts of the half circle
constexpr double kNearEnd = 0.05;                    // [-] of an edge: a cut is at least so far from its ends
constexpr std::uint32_t kNone = 0xffffffff;

class Builder {
 public:
  Builder(const DuraShell& shell, AddedMesh& out)
      : shell_(shell),
        lattice_(shell.sheet->lattice()),
        out_(out),
        at_node_(lattice_.nodes(), kNone),
        on_edge_(lattice_.edges().size() * (kParts - 1), kNone) {}

  void build() {
    std::vector<std::uint8_t> sides(lattice_.edges().size(), 0);
    std::vector<DuraRent::Nodes> triangles;
    for_each_triangle(lattice_, [&](const DuraRent::Nodes& nodes) {
      triangles.push_back(nodes);
      for (std::size_t k = 0; k < 3; ++k) ++sides[lattice_.edge(nodes[k], nodes[(k + 1) % 3])];
    });
    reserve(triangles);
    for (const auto& nodes : triangles) add_triangle(nodes);
    for (const auto& nodes : triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (sides[lattice_.edge(nodes[k], nodes[(k + 1) % 3])] == 1) add_outer_wall(nodes[k], nodes[(k + 1) % 3]);
    for (const auto& nodes : triangles)
      if (is_near(nodes)) add_brain(nodes);
  }

 private:
  /// A point of the sheet, between nodes or where the edge of a rent crosses.
  struct Corner {
    Vec3 top{0.0}, bottom{0.0}, normal{0.0};  // sheet frame
    Vec3 place{0.0};                          // of the sheet without lip
    Vec3 rest{0.0};                           // bone frame
    DuraRent::Opening opening{};
    double lip = 0.0, depth = 0.0;
    bool is_open = false, is_edge = false;
    std::uint32_t top_vertex = kNone, bottom_vertex = kNone, brain_vertex = kNone;
    std::array<std::uint32_t, kRing + 1> ring{};  // vertices of an edge, from the outer to the inner face; valid with the first
  };
  using Lattice = std::array<int, 3>;  // weights, of kParts
  using Parts = std::array<std::uint32_t, kCorners>;

  [[nodiscard]] bool is_near(const DuraRent::Nodes& nodes) const {
    return std::ranges::any_of(nodes, [this](std::uint32_t n) { return shell_.rent->is_near(n); });
  }
  /// So that little grows while it is filled: the walls of rim and rent.
  void reserve(const std::vector<DuraRent::Nodes>& triangles) {
    const auto near = static_cast<std::size_t>(std::ranges::count_if(triangles, [this](const auto& nodes) { return is_near(nodes); }));
    constexpr std::size_t kPerEdge = kParts - 1, kInner = kCorners - 3 * kParts, kParted = kParts * kParts;
    // The edge of a rent crosses some of the triangles near it, each at about two lines of parts.
    const std::size_t corners = lattice_.nodes() + kPerEdge * lattice_.edges().size() + kInner * triangles.size() + kParts * near;
    corners_.reserve(corners);
    out_.vertices.reserve(out_.vertices.size() + 2 * corners + kParted * near);
    out_.colors.reserve(out_.colors.size() + 2 * corners + kParted * near);
    out_.triangles.reserve(out_.triangles.size() + kParted * (2 * triangles.size() + 2 * near));
  }

  [[nodiscard]] std::uint32_t vertex(const Vec3& p, const Rgba8& color) {
    out_.vertices.emplace_back(shell_.bone_from_sheet * p);
    out_.colors.push_back(color);
    return static_cast<std::uint32_t>(out_.vertices.size() - 1);
  }
  [[nodiscard]] std::uint32_t again(std::uint32_t n) {
    out_.vertices.push_back(glm::vec3(out_.vertices[n]));
    out_.colors.push_back(Rgba8(out_.colors[n]));
    return static_cast<std::uint32_t>(out_.vertices.size() - 1);
  }
  std::uint32_t top_of(std::uint32_t n) {
    Corner& c = corners_[n];
    if (c.top_vertex == kNone) c.top_vertex = vertex(c.top, dura_color(c.rest, c.depth, c.lip));
    return c.top_vertex;
  }
  std::uint32_t bottom_of(std::uint32_t n) {
    Corner& c = corners_[n];
    if (c.bottom_vertex == kNone) c.bottom_vertex = vertex(c.bottom, dura_inside_color(c.rest, c.lip));
    return c.bottom_vertex;
  }
  std::uint32_t brain_of(std::uint32_t n) {
    Corner& c = corners_[n];
    if (c.brain_vertex == kNone) {
      const double open = smooth_step(DuraRent::kEdge - 0.1, DuraRent::kEdge + 0.35, c.opening.share);
      const Vec3 p = c.place - (shell_.thickness + kBrainBelow + sulcus_depth(c.rest)) * c.normal;
      c.brain_vertex = vertex(p, brain_color(c.rest, open));
    }
    return c.brain_vertex;
  }

  /// A point between nodes: on their plane, and from there towards the planes of their normals.
  [[nodiscard]] std::uint32_t add_corner(const DuraRent::Nodes& nodes, const Lattice& weights) {
    Vec3 flat(0.0), curved(0.0), normal(0.0), rest(0.0);
    bool near = false;
    const auto weight = [&](std::size_t k) { return static_cast<double>(weights[k]) / kParts; };
    for (std::size_t k = 0; k < 3; ++k) flat += weight(k) * (*shell_.positions)[nodes[k]];
    for (std::size_t k = 0; k < 3; ++k) {
      if (weights[k] == 0) continue;
      const Vec3 &x = (*shell_.positions)[nodes[k]], &n = (*shell_.normals)[nodes[k]];
      curved += weight(k) * (flat - glm::dot(flat - x, n) * n);
      normal += weight(k) * n;
      rest += weight(k) * shell_.sheet->rest(nodes[k]);
      near = near || shell_.rent->is_near(nodes[k]);
    }
    Corner c;
    c.rest = shell_.bone_from_sheet * rest;
    c.normal = glm::normalize(normal);
    c.place = glm::mix(flat, curved, kCurved);
    c.depth = rest.z - flat.z;
    if (near) {
      c.opening = shell_.rent->at(glm::dvec2(rest));
      if (c.opening.share > 0.0) c.opening.share += kFray * (tissue_noise(c.rest / kFrayWide) - 0.5);
      c.lip = smooth_step(kLipFrom, DuraRent::kEdge, c.opening.share);
      c.is_open = c.opening.share >= DuraRent::kEdge;
    }
    const double bump = kBump * (tissue_noise(c.rest / kBumpWide) - 0.5);
    c.top = c.place + Vec3(0.0, 0.0, bump) + (kCurl * c.lip * c.lip + 0.5 * kSwell * shell_.thickness * c.lip) * c.normal;
    c.bottom = c.top - shell_.thickness * (1.0 + kSwell * c.lip) * c.normal;
    corners_.push_back(c);
    return static_cast<std::uint32_t>(corners_.size() - 1);
  }
  /// Corners at a node are those of all its triangles, corners on an edge those of both.
  std::uint32_t find_corner(const DuraRent::Nodes& nodes, const Lattice& weights) {
    std::uint32_t* kept = nullptr;
    for (std::size_t k = 0; k < 3 && kept == nullptr; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (weights[k] == kParts)
        kept = &at_node_[nodes[k]];
      else if (weights[k] > 0 && weights[next] > 0 && weights[k] + weights[next] == kParts)
        kept = &on_edge_[lattice_.edge(nodes[k], nodes[next]) * (kParts - 1) +
                         static_cast<std::size_t>(nodes[k] < nodes[next] ? weights[k] : weights[next]) - 1];
    }
    if (kept == nullptr) return add_corner(nodes, weights);
    if (*kept == kNone) *kept = add_corner(nodes, weights);
    return *kept;
  }
  [[nodiscard]] Parts find_parts(const DuraRent::Nodes& nodes) {
    Parts out{};
    std::size_t next = 0;
    for (int i = 0; i <= kParts; ++i)
      for (int j = 0; i + j <= kParts; ++j) out[next++] = find_corner(nodes, {kParts - i - j, i, j});
    return out;
  }
  /// All corners of a triangle, row by row; those near a rent are kept, since the triangle is met for the shell and for the brain.
  template <class F>
  void for_each_part(const DuraRent::Nodes& nodes, F&& f) {
    Parts all{};
    if (const auto kept = near_.find(nodes); kept != near_.end())
      all = kept->second;
    else
      all = find_parts(nodes);
    if (is_near(nodes)) near_.try_emplace(nodes, all);
    const auto corner = [&](int i, int j) {
      const int at = i * (kParts + 1) - i * (i - 1) / 2 + j;
      return all[static_cast<std::size_t>(at)];
    };
    for (int i = 0; i < kParts; ++i)
      for (int j = 0; i + j < kParts; ++j) {
        f(corner(i, j), corner(i + 1, j), corner(i, j + 1));
        if (i + j + 1 < kParts) f(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
      }
  }

  void add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    out_.triangles.push_back({top_of(a), top_of(b), top_of(c)});
    out_.triangles.push_back({bottom_of(a), bottom_of(c), bottom_of(b)});
  }
  /// Where the edge of a rent crosses the line between two corners, one of which it opens.
  std::uint32_t find_crossing(std::uint32_t a, std::uint32_t b) {
    const auto [at, fresh] = crossings_.try_emplace({std::min(a, b), std::max(a, b)}, kNone);
    if (!fresh) return at->second;
    const Corner &from = corners_[std::min(a, b)], &to = corners_[std::max(a, b)];
    const double rise = to.opening.share - from.opening.share;
    const double t = std::clamp((DuraRent::kEdge - from.opening.share) / rise, kNearEnd, 1.0 - kNearEnd);
    Corner c;
    c.top = glm::mix(from.top, to.top, t);
    c.bottom = glm::mix(from.bottom, to.bottom, t);
    c.normal = glm::normalize(glm::mix(from.normal, to.normal, t));
    c.rest = glm::mix(from.rest, to.rest, t);
    c.depth = glm::mix(from.depth, to.depth, t);
    c.opening = {DuraRent::kEdge, glm::mix(from.opening.slope, to.opening.slope, t)};
    c.lip = 1.0;
    c.is_edge = true;
    corners_.push_back(c);
    return at->second = static_cast<std::uint32_t>(corners_.size() - 1);
  }
  void add_triangle(const DuraRent::Nodes& nodes) {
    for_each_part(nodes, [this](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      const std::array<std::uint32_t, 3> corner{a, b, c};
      std::array<std::uint32_t, 4> polygon{};
      std::array<std::uint32_t, 2> cut{};  // from, to, with the sheet on the left
      std::size_t count = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t p = corner[k], q = corner[(k + 1) % 3];
        const bool opens = corners_[p].is_open, next = corners_[q].is_open;
        if (!opens) polygon[count++] = p;
        if (opens != next) cut[next ? 0 : 1] = polygon[count++] = find_crossing(p, q);
      }
      for (std::size_t k = 2; k < count; ++k) add_face(polygon[0], polygon[k - 1], polygon[k]);
      if (count > 0 && std::ranges::any_of(corner, [this](std::uint32_t n) { return corners_[n].is_open; })) add_lip(cut[0], cut[1]);
    });
  }

  /// The half circle between both faces, out into the rent.
  const std::array<std::uint32_t, kRing + 1>& ring_of(std::uint32_t n) {
    if (corners_[n].ring[0] == 0 && corners_[n].ring[kRing] == 0) {
      std::array<std::uint32_t, kRing + 1> ring{};
      ring[0] = top_of(n);
      ring[kRing] = bottom_of(n);
      const Corner c = corners_[n];
      const Vec3 middle = 0.5 * (c.top + c.bottom), up = c.top - middle;
      const Vec3 slope(c.opening.slope, 0.0), along = slope - glm::dot(slope, c.normal) * c.normal;
      const Vec3 out = glm::length(along) > 0.0 ? glm::length(up) * glm::normalize(along) : Vec3(0.0);
      for (int k = 1; k < kRing; ++k) {
        const double turn = std::numbers::pi * k / kRing;
        ring[static_cast<std::size_t>(k)] = vertex(middle + std::cos(turn) * up + std::sin(turn) * out,
                                                   dura_inside_color(c.rest, smooth_step(0.0, 0.5, static_cast<double>(k) / kRing)));
      }
      corners_[n].ring = ring;
    }
    return corners_[n].ring;
  }
  void add_lip(std::uint32_t a, std::uint32_t b) {
    (void)ring_of(a);
    add_strip(std::array(ring_of(a)), ring_of(b));
  }
  /// Between two lines of vertices from the outer to the inner face, the sheet on the left from a to b.
  void add_strip(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
    for (std::size_t i = 0, j = 0; i + 1 < a.size() || j + 1 < b.size();) {
      if (j + 1 == b.size() || (i + 1 < a.size() && i * (b.size() - 1) <= j * (a.size() - 1))) {
        out_.triangles.push_back({a[i], a[i + 1], b[j]});
        ++i;
      } else {
        out_.triangles.push_back({b[j], a[i], b[j + 1]});
        ++j;
      }
    }
  }

  /// From a to b with the sheet on the left; vertices of its own, so that the edge is sharp.
  void add_outer_wall(std::uint32_t a, std::uint32_t b) {
    const auto line_of = [this](std::uint32_t n) {
      std::vector<std::uint32_t> line;
      if (corners_[n].is_edge)
        for (const std::uint32_t one : std::array(ring_of(n))) line.push_back(again(one));
      else
        line = {again(top_of(n)), again(bottom_of(n))};
      return line;
    };
    const auto corner = [&](int i) { return find_corner({a, b, a}, {kParts - i, i, 0}); };
    for (int i = 0; i < kParts; ++i) {
      std::uint32_t p = corner(i), q = corner(i + 1);
      if (corners_[p].is_open && corners_[q].is_open) continue;
      if (corners_[p].is_open)
        p = find_crossing(p, q);
      else if (corners_[q].is_open)
        q = find_crossing(p, q);
      const std::vector<std::uint32_t> from = line_of(p);
      add_strip(from, line_of(q));
    }
  }
  void add_brain(const DuraRent::Nodes& nodes) {
    for_each_part(nodes, [this](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      out_.triangles.push_back({brain_of(a), brain_of(b), brain_of(c)});
    });
  }

  const DuraShell& shell_;
  const SheetLattice& lattice_;
  AddedMesh& out_;
  std::vector<Corner> corners_;
  std::vector<std::uint32_t> at_node_, on_edge_;                                // corners
  std::map<DuraRent::Nodes, Parts> near_;                                       // corners of triangles near a rent
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> crossings_;  // corners
};

}  // namespace

void append_dura(const DuraShell& shell, AddedMesh& out) { Builder(shell, out).build(); }

}  // namespace burrhole
