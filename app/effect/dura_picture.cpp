#include "app/effect/dura_picture.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace burrhole {
namespace {

constexpr double kMoved = 5e-6;    // [m] of a node, above which the next picture shows it
constexpr double kTopMoved = 0.1;  // [voxels] of the upper face of soft tissue, above which its voxels are drawn anew
constexpr double kBelowTear =
    1e-3;  // [m] of the brain below the dura under a tear (an assumption: what covers the brain itself is torn too)
constexpr double kLeastBelow = 1e-4;                    // [m] of soft tissue below the upper face
constexpr double kAbove = 2e-3;                         // [m] over the sheet at rest, up to which soft tissue is left out
constexpr double kCurved = 0.75;                        // [-] share of the curvature between nodes: Phong tessellation
constexpr double kLeastSlope = 0.3;                     // [-] of a normal along z; steeper faces count as that
constexpr int kParts = 5;                               // of an edge
constexpr double kBump = 50e-6, kBumpWide = 0.7e-3;     // [m] height and width of what breaks the gloss (an assumption)
constexpr double kDarkFrom = 4e-3, kLeastLight = 0.35;  // [m], [-] depth at which a pit is dark, and by how much (an assumption)
constexpr std::uint8_t kShine = 200;

std::uint32_t mixed(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ z * 0xC2B2AE3Du;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  return h ^ (h >> 13);
}

double smooth(double lo, double hi, double x) {
  const double t = std::clamp((x - lo) / (hi - lo), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// As shaders/noise.glsl and tissue.glsl, which colour the dura of voxels.
double noise(const Vec3& x) {
  const Vec3i cell = floor_int(x);
  Vec3 f = x - Vec3(cell);
  f = f * f * (3.0 - 2.0 * f);
  double sum = 0.0;
  for (unsigned c = 0; c < 8; ++c) {
    const Vec3i at = cell + cell_corner(c);
    const Vec3 w = glm::mix(1.0 - f, f, Vec3(cell_corner(c)));
    const std::uint32_t h = mixed(static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y), static_cast<std::uint32_t>(at.z));
    sum += w.x * w.y * w.z * static_cast<double>(h >> 8) / 16777216.0;
  }
  return sum;
}

double vessel(const Vec3& x, const Vec3& way, double width) {
  const double along = glm::dot(x, way) + 0.5 * noise(x) + 0.12 * noise(2.3 * x);
  const double off = std::abs(along - std::floor(along) - 0.5);
  return (1.0 - smooth(0.4 * width, width, off)) * smooth(0.35, 0.6, noise(0.43 * x + 17.0));
}

/// Dura with its vessels and fibres. @param p [m] at rest. @param torn 0..1, 1 at the edge of a tear. @param depth [m] below its place at rest.
Rgba8 color_of(const Vec3& p, double torn, double depth) {
  const double trunk = vessel(p / 6.0e-3, Vec3(0.8, 0.36, 0.48), 0.06);
  const double branch = vessel(p / 2.8e-3 + 5.0, Vec3(0.28, 0.96, 0.0), 0.08);
  Vec3 color = Vec3(0.80, 0.65, 0.61) * (0.92 + 0.14 * noise(p / Vec3(0.5e-3, 2.2e-3, 0.5e-3)));
  color = glm::mix(color, Vec3(0.60, 0.16, 0.15), std::max(0.85 * trunk, 0.6 * branch));
  color = glm::mix(color, Vec3(0.62, 0.14, 0.13), 0.75 * torn);  // blood in the edge of a tear
  color *= 1.0 - kLeastLight * smooth(0.0, kDarkFrom, depth);
  const auto byte = [](double share) { return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(share, 0.0, 1.0))); };
  return {byte(color.x), byte(color.y), byte(color.z), kShine};
}

/// The shell that one picture shows: fine triangles between the nodes, on both faces, and walls along open edges.
class Shell {
 public:
  struct Nodes {
    const std::vector<Vec3>&x, &normals;  // sheet frame
  };
  Shell(const ElasticSheet& sheet, const Nodes& nodes, const Pose& bone_from_sheet, double thickness, AddedMesh& out)
      : sheet_(&sheet),
        x_(&nodes.x),
        normals_(&nodes.normals),
        bone_from_sheet_(bone_from_sheet),
        thickness_(thickness),
        out_(&out),
        torn_(nodes.x.size(), 0.0) {}

  void note(const std::array<std::uint32_t, 3>& nodes, bool whole) {
    if (!whole) {
      for (const std::uint32_t n : nodes) torn_[n] = 1.0;
      return;
    }
    triangles_.push_back(nodes);
    for (std::size_t k = 0; k < 3; ++k) ++open_[{std::min(nodes[k], nodes[(k + 1) % 3]), std::max(nodes[k], nodes[(k + 1) % 3])}];
  }

  void build() {
    for (const auto& nodes : triangles_) add_triangle(nodes);
    for (const auto& nodes : triangles_)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = nodes[k], b = nodes[(k + 1) % 3];
        if (open_.at({std::min(a, b), std::max(a, b)}) == 1) add_wall(a, b);
      }
  }

 private:
  struct Corner {
    std::array<std::uint32_t, 3> nodes{};
    std::array<int, 3> weights{};  // of kParts
  };
  struct Pair {
    std::uint32_t top = 0, bottom = 0;
  };

  /// A point between nodes: on their plane, and from there towards the planes of their normals.
  [[nodiscard]] Pair add_corner(const Corner& corner) {
    Vec3 flat(0.0), curved(0.0), normal(0.0), rest(0.0);
    double torn = 0.0;
    const auto weight = [&](std::size_t k) { return static_cast<double>(corner.weights[k]) / kParts; };
    for (std::size_t k = 0; k < 3; ++k) flat += weight(k) * (*x_)[corner.nodes[k]];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t n = corner.nodes[k];
      curved += weight(k) * (flat - glm::dot(flat - (*x_)[n], (*normals_)[n]) * (*normals_)[n]);
      normal += weight(k) * (*normals_)[n];
      rest += weight(k) * sheet_->rest(n);
      torn += weight(k) * torn_[n];
    }
    const double bump = kBump * (noise(bone_from_sheet_ * rest / kBumpWide) - 0.5);
    const Vec3 top = glm::mix(flat, curved, kCurved) + Vec3(0.0, 0.0, bump), bottom = top - thickness_ * glm::normalize(normal);
    const Rgba8 color = color_of(bone_from_sheet_ * rest, torn * torn, rest.z - flat.z);
    const auto add = [&](const Vec3& p) {
      out_->vertices.emplace_back(bone_from_sheet_ * p);
      out_->colors.push_back(color);
      return static_cast<std::uint32_t>(out_->vertices.size() - 1);
    };
    const std::uint32_t first = add(top);
    return {first, add(bottom)};
  }
  /// Corners on an edge are those of both its triangles.
  [[nodiscard]] Pair find_corner(const Corner& corner) {
    std::array<std::pair<std::uint32_t, int>, 3> key{};
    for (std::size_t k = 0; k < 3; ++k) key[k] = corner.weights[k] > 0 ? std::pair{corner.nodes[k], corner.weights[k]} : std::pair{0u, 0};
    std::ranges::sort(key);
    const auto [at, fresh] = corners_.try_emplace(key);
    if (fresh) at->second = add_corner(corner);
    return at->second;
  }
  void add_triangle(const std::array<std::uint32_t, 3>& nodes) {
    const auto at = [&](int i, int j) { return find_corner({nodes, {kParts - i - j, i, j}}); };
    const auto both = [&](const Pair& a, const Pair& b, const Pair& c) {
      out_->triangles.push_back({a.top, b.top, c.top});
      out_->triangles.push_back({a.bottom, c.bottom, b.bottom});
    };
    for (int i = 0; i < kParts; ++i)
      for (int j = 0; i + j < kParts; ++j) {
        const Pair a = at(i, j), b = at(i + 1, j), c = at(i, j + 1);
        both(a, b, c);
        if (i + j + 1 < kParts) both(b, at(i + 1, j + 1), c);
      }
  }
  /// From a to b with the sheet on the left; corners of its own, so that the edge is sharp.
  void add_wall(std::uint32_t a, std::uint32_t b) {
    const auto copy = [this](std::uint32_t n) {
      out_->vertices.push_back(glm::vec3(out_->vertices[n]));
      out_->colors.push_back(Rgba8(out_->colors[n]));
      return static_cast<std::uint32_t>(out_->vertices.size() - 1);
    };
    Pair last{};
    for (int i = 0; i <= kParts; ++i) {
      const Pair shared = find_corner({{a, b, a}, {kParts - i, i, 0}});
      const std::uint32_t top = copy(shared.top);
      const Pair now{top, copy(shared.bottom)};
      if (i > 0) {
        out_->triangles.push_back({last.top, last.bottom, now.top});
        out_->triangles.push_back({now.top, last.bottom, now.bottom});
      }
      last = now;
    }
  }

  const ElasticSheet* sheet_;
  const std::vector<Vec3>*x_, *normals_;
  Pose bone_from_sheet_;
  double thickness_;
  AddedMesh* out_;
  std::vector<double> torn_;  // [-] of nodes, 1 at a tear
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> open_;  // whole triangles at an edge
  std::map<std::array<std::pair<std::uint32_t, int>, 3>, Pair> corners_;
};

}  // namespace

DuraPicture::DuraPicture(const ElasticSheet& sheet, const Pose& bone_from_sheet, double thickness, double edge)
    : sheet_(&sheet), bone_from_sheet_(bone_from_sheet), sheet_from_bone_(bone_from_sheet.inverse()), thickness_(thickness), edge_(edge) {}

bool DuraPicture::is_whole(std::uint32_t a, std::uint32_t b, std::uint32_t c) const noexcept {
  const SheetLattice& lattice = sheet_->lattice();
  return broken_[lattice.edge(a, b)] == 0 && broken_[lattice.edge(b, c)] == 0 && broken_[lattice.edge(c, a)] == 0;
}

bool DuraPicture::copy_for_picture(bool exactly) {
  const SheetLattice& lattice = sheet_->lattice();
  changed_ = Bounds::none();
  const bool first = x_.empty();
  bool differs = first;
  for (std::size_t n = 0; n < lattice.nodes() && !differs; ++n)
    differs = glm::length(sheet_->position(n) - x_[n]) > (exactly ? 0.0 : kMoved);
  for (std::size_t e = 0; e < lattice.edges().size() && !differs; ++e) differs = sheet_->is_broken(e) != (broken_[e] != 0);
  if (!differs && (!exactly || exact_)) return false;
  exact_ = exactly;
  x_.resize(lattice.nodes());
  broken_.resize(lattice.edges().size());
  for (std::size_t n = 0; n < x_.size(); ++n) x_[n] = sheet_->position(n);
  for (std::size_t e = 0; e < broken_.size(); ++e) broken_[e] = sheet_->is_broken(e) ? 1 : 0;
  find_normals();
  // z of the shell over the place of a node at rest, from which the node has moved aside.
  const auto over_rest = [this](std::size_t n) {
    const Vec3 moved = x_[n] - sheet_->rest(n), &normal = normals_[n];
    const double z = x_[n].z + (normal.x * moved.x + normal.y * moved.y) / std::max(normal.z, kLeastSlope);
    return std::min(z, sheet_->rest(n).z);
  };
  std::vector<double> wanted(x_.size());
  // Within the shell, but below its upper face by more than the ramp of the voxels.
  const double below = std::max(thickness_ - 0.25 * edge_, 0.5 * edge_ + kLeastBelow);
  for (std::size_t n = 0; n < x_.size(); ++n) wanted[n] = over_rest(n) - below;
  for (std::size_t e = 0; e < broken_.size(); ++e)
    if (broken_[e] != 0)
      for (const std::uint32_t n : {lattice.edges()[e].a, lattice.edges()[e].b}) wanted[n] = over_rest(n) - thickness_ - kBelowTear;
  lower_soft(wanted, exactly ? 0.0 : kTopMoved * edge_);
  return true;
}

/// Takes over the heights that differ by more than `seen` [m], with the boxes in which voxels change.
void DuraPicture::lower_soft(const std::vector<double>& wanted, double seen) {
  const bool first = top_.empty();
  if (first) top_ = wanted;
  Bounds changed = Bounds::none(), all = Bounds::none();
  const double reach = sheet_->lattice().spacing();
  for (std::size_t n = 0; n < top_.size(); ++n) {
    const Vec3 rest = sheet_->rest(n);
    all.include(rest + Vec3(-reach, -reach, kAbove));
    all.include({rest.x + reach, rest.y + reach, std::min(top_[n], wanted[n]) - 2.0 * edge_});
    if (!first && std::abs(wanted[n] - top_[n]) <= seen) continue;
    changed.include({rest.x - reach, rest.y - reach, std::min(top_[n], wanted[n]) - 2.0 * edge_});
    changed.include({rest.x + reach, rest.y + reach, first ? rest.z + kAbove : std::max(top_[n], wanted[n]) + 2.0 * edge_});
    top_[n] = wanted[n];
  }
  extent_ = bounds_under(bone_from_sheet_, all);
  if (changed.lo.x <= changed.hi.x) changed_ = bounds_under(bone_from_sheet_, changed);
}

double DuraPicture::shown(const Vec3& p_bone, double edge) const {
  const Vec3 p = sheet_from_bone_ * p_bone;
  const auto place = sheet_->lattice().find(p.x, p.y);
  if (!place) return 1.0;
  double top = 0.0, rest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    top += place->weights[k] * top_[place->nodes[k]];
    rest += place->weights[k] * sheet_->rest(place->nodes[k]).z;
  }
  return p.z > rest + kAbove ? 1.0 : std::clamp(0.5 + (top - p.z) / edge, 0.0, 1.0);
}

template <class F>
void DuraPicture::for_each_triangle(F&& f) const {
  const SheetLattice& lattice = sheet_->lattice();
  for (std::uint32_t n = 0; n < x_.size(); ++n) {
    const SheetLattice::Neighbours& beside = lattice.neighbours(n);
    for (std::size_t k = 0; k < 2; ++k) {
      const std::uint32_t b = beside[k], c = beside[k + 1];
      if (b != SheetLattice::kNoNode && c != SheetLattice::kNoNode) f(std::array{n, b, c}, is_whole(n, b, c));
    }
  }
}

void DuraPicture::find_normals() {
  normals_.assign(x_.size(), Vec3(0.0));
  for_each_triangle([this](const std::array<std::uint32_t, 3>& nodes, bool whole) {
    const Vec3 normal = glm::cross(x_[nodes[1]] - x_[nodes[0]], x_[nodes[2]] - x_[nodes[0]]);
    if (whole)
      for (const std::uint32_t n : nodes) normals_[n] += normal;
  });
  for (Vec3& normal : normals_) normal = glm::length(normal) > 0.0 ? glm::normalize(normal) : Vec3(0.0, 0.0, 1.0);
}

void DuraPicture::append_mesh(AddedMesh& out) const {
  Shell shell(*sheet_, {x_, normals_}, bone_from_sheet_, thickness_, out);
  for_each_triangle([&](const std::array<std::uint32_t, 3>& nodes, bool whole) { shell.note(nodes, whole); });
  shell.build();
}

}  // namespace burrhole
