#include "core/tool/fluted_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "core/base/portable_math.h"
#include "core/tool/tool_mesh.h"

namespace burrhole {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kArcSteps = 32;      ///< per curved piece
constexpr int kLeastCorners = 64;  ///< per ring
constexpr double kStep = 0.5e-3;   ///< [m] axial step on a cutting flank
constexpr double kCrease = 0.8;    ///< [-] cosine of the largest angle between faces that share a normal: 37 degrees

/// Profile of one cutting edge around the circumference, from the edge against the direction of rotation: land, relief, flute of the next
/// edge.
struct ProfilePoint {
  double share, depth, fall;  ///< [-] position 0..1, depth of the flute 0..1, axial relief of a flat end 0..1
};
constexpr std::array kProfile{ProfilePoint{0.0, 0.0, 0.0},    ProfilePoint{0.06, 0.0, 0.08}, ProfilePoint{0.30, 0.35, 0.40},
                              ProfilePoint{0.50, 0.75, 0.65}, ProfilePoint{0.70, 1.0, 0.90}, ProfilePoint{0.92, 1.0, 1.0}};

// Of a twist drill: margin, land with body clearance, flute down to the web. Usual proportions of drills of this size: a margin of a tenth and a
// land of half of the pitch of the flutes, a body clearance of 4 % of the radius, a web of 0.3 of the diameter, a back taper of 2 % here so that
// the margins in the hole are seen.
constexpr double kDrillFlute = 0.7, kBackTaper = 0.98;  // [-] deepest flute, of the radius; radius of the body, of the point's
constexpr std::array kDrillProfile{ProfilePoint{0.0, 0.0, 0.0},   ProfilePoint{0.06, 0.0, 0.0},  ProfilePoint{0.08, 0.06, 0.0},
                                   ProfilePoint{0.22, 0.06, 0.0}, ProfilePoint{0.36, 0.06, 0.0}, ProfilePoint{0.50, 0.06, 0.0},
                                   ProfilePoint{0.58, 0.55, 0.0}, ProfilePoint{0.70, 1.0, 0.0},  ProfilePoint{0.84, 1.0, 0.0},
                                   ProfilePoint{0.94, 0.64, 0.0}};

bool cuts(const ToolSpec& spec, const OutlinePiece& piece) { return spec.regions[piece.solid].erosion.base > 0.0; }

bool meets(double a, double b) { return std::abs(a - b) < kOutlineTolerance; }

bool meet(const Meridian& a, const Meridian& b) { return glm::length(a - b) < kOutlineTolerance; }

/// Corners of a ring; every ring of a bit has the same number.
std::vector<ProfilePoint> ring_profile(int edges, std::span<const ProfilePoint> profile) {
  const int corners = edges * static_cast<int>(profile.size()), between = std::max(1, (kLeastCorners + corners - 1) / corners);
  std::vector<ProfilePoint> ring;
  for (int edge = 0; edge < edges; ++edge)
    for (std::size_t n = 0; n < profile.size(); ++n) {
      const ProfilePoint from = profile[n], to = n + 1 < profile.size() ? profile[n + 1] : ProfilePoint{1.0, 0.0, 0.0};
      for (int i = 0; i < between; ++i) {
        const double t = static_cast<double>(i) / between;
        ring.push_back({(edge + from.share + t * (to.share - from.share)) / edges, from.depth + t * (to.depth - from.depth),
                        from.fall + t * (to.fall - from.fall)});
      }
    }
  return ring;
}

/// Heights between which the bit cuts. The helix turns within this range only.
std::pair<double, double> cutting_heights(const ToolSpec& spec) {
  double low = 1e9, high = -1e9;
  for (const OutlinePiece& piece : spec.outline)
    if (cuts(spec, piece)) {
      low = std::min({low, piece.start.y, piece.end.y});
      high = std::max({high, piece.start.y, piece.end.y});
    }
  return {low, high};
}

/// @returns the region of the body of a twist drill: the passive cylinder on the part that cuts, if that is a cone with two lips. Its flutes
/// continue those of the lips.
std::optional<std::size_t> find_drill_body(const ToolSpec& spec, const CuttingEdges& edges) {
  if (edges.count != 2 || edges.twist == 0.0) return std::nullopt;
  const double top = cutting_heights(spec).second;
  for (std::size_t n = 0; n < spec.regions.size(); ++n) {
    const RegionSpec& region = spec.regions[n];
    if (region.erosion.base <= 0.0 && region.solid.kind == SolidKind::frustum && meets(region.solid.z_low, top)) return n;
  }
  return std::nullopt;
}

class FlutedBit {
 public:
  FlutedBit(const ToolSpec& spec, const CuttingEdges& edges)
      : spec_(&spec),
        edges_(edges),
        heights_(cutting_heights(spec)),
        body_(find_drill_body(spec, edges)),
        profile_(body_ ? ring_profile(edges.count, kDrillProfile) : ring_profile(edges.count, kProfile)) {
    if (!body_) return;
    heights_.second = spec.regions[*body_].solid.z_high;
    edges_.depth = kDrillFlute;
    web_ = (1.0 - kDrillFlute) * spec.regions[*body_].solid.largest_radius();
  }

  [[nodiscard]] std::vector<Vec3> triangles() {
    for (const OutlineChain chain : chains_of(spec_->outline))
      for (std::size_t n = 0; n < chain.size(); ++n) append(chain, n);
    return std::move(corners_);
  }

 private:
  /// The piece of the chain that adjoins this one at `place`; a ring closes on itself. Null at the axis.
  static const OutlinePiece* neighbour(OutlineChain chain, std::size_t n, bool at_start) {
    const Meridian& place = at_start ? chain[n].start : chain[n].end;
    const OutlinePiece& other = chain[at_start ? (n + chain.size() - 1) % chain.size() : (n + 1) % chain.size()];
    return chain.size() > 1 && meet(at_start ? other.end : other.start, place) ? &other : nullptr;
  }

  [[nodiscard]] bool is_fluted(const OutlinePiece& piece) const { return cuts(*spec_, piece) || piece.solid == body_; }

  void append(OutlineChain chain, std::size_t n) {
    const OutlinePiece& piece = chain[n];
    const bool cutting = is_fluted(piece);
    int steps = piece.curved ? kArcSteps : 1;
    if (cutting && !piece.curved && piece.face != Face::bottom && piece.face != Face::top)
      steps = std::clamp(static_cast<int>(std::ceil(piece.length() / kStep)), 4, 96);
    std::vector<Vec3> before;
    for (int i = 0; i <= steps; ++i) {
      const bool end = i == 0 || i == steps;
      const OutlinePiece* other = end ? neighbour(chain, n, i == 0) : nullptr;
      // A passive piece starts without a flute; otherwise the surface would have a gap.
      const bool fluted = cutting && (other == nullptr || is_fluted(*other));
      const bool falls = fluted && other != nullptr && other->solid == piece.solid && at_bottom(piece, i == 0 ? piece.start : piece.end);
      std::vector<Vec3> ring = make_ring(piece, piece.point(static_cast<double>(i) / steps), fluted, falls);
      if (i > 0) append_band(before, ring);
      before = std::move(ring);
    }
  }

  [[nodiscard]] bool at_bottom(const OutlinePiece& piece, const Meridian& at) const {
    const Solid& solid = spec_->regions[piece.solid].solid;
    return solid.kind == SolidKind::frustum && std::abs(at.y - solid.z_low) < kOutlineTolerance;
  }

  [[nodiscard]] std::vector<Vec3> make_ring(const OutlinePiece& piece, const Meridian& at, bool fluted, bool falls) const {
    const Solid& solid = spec_->regions[piece.solid].solid;
    const double turned = edges_.twist * (std::clamp(at.y, heights_.first, heights_.second) - heights_.first);
    std::vector<Vec3> ring;
    for (const ProfilePoint& p : profile_) {
      const double angle = kTurn * p.share + turned;
      const double z = at.y + (falls ? edges_.relief * p.fall : 0.0);
      double r = at.x * (fluted ? 1.0 - edges_.depth * p.depth : 1.0);
      r = std::max(r, std::min(at.x, web_));  // the web of a drill reaches into its point
      // An inclined flank uses the end with the relief of the adjoining end face.
      if (falls && meets(at.x, solid.low_radius)) r *= solid.radius(z) / solid.low_radius;
      if (falls && solid.low_bore > 0.0 && meets(at.x, solid.low_bore)) r *= solid.bore(z) / solid.low_bore;
      ring.emplace_back(r * portable_cos(angle), r * portable_sin(angle), z);
    }
    return ring;
  }

  void append_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    if (a == b || b == c || c == a) return;  // at the axis
    corners_.insert(corners_.end(), {a, b, c});
  }

  void append_band(const std::vector<Vec3>& lower, const std::vector<Vec3>& upper) {
    for (std::size_t i = 0; i < lower.size(); ++i) {
      const std::size_t j = (i + 1) % lower.size();
      append_triangle(lower[i], lower[j], upper[j]);
      append_triangle(lower[i], upper[j], upper[i]);
    }
  }

  const ToolSpec* spec_;
  CuttingEdges edges_;
  std::pair<double, double> heights_;  // [m]
  std::optional<std::size_t> body_;    // region
  std::vector<ProfilePoint> profile_;
  double web_ = 0.0;  // [m] radius
  std::vector<Vec3> corners_;
};

/// The normal of a corner is the area-weighted mean of the adjacent faces that meet the corner's own face smoothly.
void append_creased(TriangleMesh& mesh, const std::vector<Vec3>& corners) {
  using Key = std::array<float, 3>;
  const auto key = [](const Vec3& p) { return Key{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}; };
  std::map<Key, std::vector<Vec3>> round;  // normals of adjacent faces, of length twice the area
  const auto area = [&](std::size_t t) { return glm::cross(corners[t + 1] - corners[t], corners[t + 2] - corners[t]); };
  for (std::size_t n = 0; n < corners.size(); ++n) round[key(corners[n])].push_back(area(n - n % 3));
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const Vec3 own = area(n - n % 3);
    Vec3 sum(0.0);
    for (const Vec3& other : round[key(corners[n])])
      if (glm::dot(own, other) > kCrease * glm::length(own) * glm::length(other)) sum += other;
    const double size = glm::length(sum);
    mesh.positions.emplace_back(corners[n]);
    mesh.normals.emplace_back(size > 0.0 ? sum / size : Vec3(0.0, 0.0, 1.0));
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size() - 1));
  }
}

}  // namespace

namespace {

/// The edges by the shape of the bit.
CuttingEdges edges_by_shape(const ToolSpec& spec) {
  const Solid* lowest = nullptr;
  double widest = 0.0;
  for (const RegionSpec& region : spec.regions) {
    if (!(region.erosion.base > 0.0) || !region.solid.revolves()) continue;
    if (lowest == nullptr || region.solid.z_low < lowest->z_low) lowest = &region.solid;
    widest = std::max(widest, region.solid.largest_radius());
  }
  if (lowest == nullptr) return {};
  const auto every = [widest](double girth, int least, int most) {
    return std::clamp(static_cast<int>(std::round(kTurn * widest / girth)), least, most);
  };
  if (lowest->bored()) return {.count = every(2.5e-3, 8, 24), .relief = std::min(1e-3, 0.3 * lowest->height())};
  const bool frustum = lowest->kind == SolidKind::frustum;
  if (frustum && lowest->low_radius == 0.0) return {.count = 2, .twist = 0.58 / widest, .depth = 0.42};
  if (frustum && widest >= 4e-3) return {.count = 4, .depth = 0.13, .relief = std::min(0.5e-3, 0.3 * lowest->height())};
  return {.count = every(1.6e-3, 6, 12),
          .twist = 0.35 / widest,
          .depth = 0.12,
          .relief = frustum ? std::min(0.2e-3, 0.3 * lowest->height()) : 0.0};
}

/// A range of the width of a saw's tooth at two heights.
struct Trapezoid {
  double low, high;                             // [m] heights
  double from_low, to_low, from_high, to_high;  // [m] x at them
};

/// Appends a prism across the blade, closed and seen counter-clockwise from outside.
void append_prism(const Trapezoid& t, double y_low, double y_high, std::vector<Vec3>& corners) {
  const auto at = [&](bool right, bool front, bool top) {
    const double x = top ? (right ? t.to_high : t.from_high) : (right ? t.to_low : t.from_low);
    return Vec3(x, front ? y_low : y_high, top ? t.high : t.low);
  };
  const auto quad = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { corners.insert(corners.end(), {a, b, c, a, c, d}); };
  quad(at(false, true, false), at(true, true, false), at(true, true, true), at(false, true, true));
  quad(at(true, false, false), at(false, false, false), at(false, false, true), at(true, false, true));
  quad(at(false, false, false), at(false, true, false), at(false, true, true), at(false, false, true));
  quad(at(true, true, false), at(true, false, false), at(true, false, true), at(true, true, true));
  quad(at(false, false, false), at(true, false, false), at(true, true, false), at(false, true, false));
  quad(at(false, true, true), at(true, true, true), at(true, false, true), at(false, false, true));
}

/// The teeth of a blade: boxes that cut, with notches from below. Boxes on each other share their notches.
std::vector<Vec3> saw_teeth(const ToolSpec& spec) {
  constexpr double kPitch = 1.2e-3, kTip = 0.12,
                   kNotch = 0.8;  // [m] from tooth to tooth; [-] of it that is flat; [-] of the height that cuts
  double low = 1e9, high = -1e9, half = 0.0;
  const auto is_part = [](const RegionSpec& region) { return !region.solid.revolves() && region.erosion.base > 0.0; };
  for (const RegionSpec& region : spec.regions) {
    if (!is_part(region)) continue;
    low = std::min(low, region.solid.z_low);
    high = std::max(high, region.solid.z_high);
    half = std::max(half, region.solid.half_size.x);
  }
  std::vector<Vec3> corners;
  if (half <= 0.0) return corners;
  const int count = std::max(2, static_cast<int>(std::round(2.0 * half / kPitch)));
  const double pitch = 2.0 * half / count, root = low + kNotch * (high - low);
  const auto share = [&](double z) { return z >= root ? 1.0 : kTip + (1.0 - kTip) * (z - low) / (root - low); };
  for (const RegionSpec& region : spec.regions) {
    if (!is_part(region)) continue;
    const Solid& solid = region.solid;
    const double left = solid.middle.x - solid.half_size.x, right = solid.middle.x + solid.half_size.x;
    const double y_low = solid.middle.y - solid.half_size.y, y_high = solid.middle.y + solid.half_size.y;
    const double top = std::min(solid.z_high, root);
    for (int n = 0; n < count && top > solid.z_low; ++n) {
      const double middle = solid.middle.x - half + (n + 0.5) * pitch;
      const auto from = [&](double z) { return std::max(left, middle - 0.5 * pitch * share(z)); };
      const auto to = [&](double z) { return std::min(right, middle + 0.5 * pitch * share(z)); };
      append_prism({solid.z_low, top, from(solid.z_low), to(solid.z_low), from(top), to(top)}, y_low, y_high, corners);
    }
    if (const double base = std::max(solid.z_low, root); base < solid.z_high)
      append_prism({base, solid.z_high, left, right, left, right}, y_low, y_high, corners);
  }
  return corners;
}

}  // namespace

CuttingEdges find_cutting_edges(const ToolSpec& spec) {
  CuttingEdges out = edges_by_shape(spec);
  if (out.count > 0 && spec.teeth > 0) out.count = spec.teeth;
  return out;
}

int teeth_of(const ToolSpec& spec) {
  constexpr int kToAndFro = 2;  // a blade whose stroke a revolution stands for passes a place twice
  if (spec.teeth > 0) return spec.teeth;
  const int edges = find_cutting_edges(spec).count;
  return edges > 0 ? edges : kToAndFro;
}

ToolSpec as_drawn(const ToolSpec& spec) {
  const auto body = find_drill_body(spec, find_cutting_edges(spec));
  if (!body) return spec;
  double widest = 0.0;
  for (const RegionSpec& region : spec.regions)
    if (region.erosion.base > 0.0) widest = std::max(widest, region.solid.largest_radius());
  ToolSpec out = spec;
  Solid& solid = out.regions[*body].solid;
  if (solid.largest_radius() >= kBackTaper * widest) return spec;
  solid.low_radius = solid.high_radius = kBackTaper * widest;
  auto outline = make_outline(out.solids());
  if (!outline) return spec;  // no single body any more: other regions lie round it
  out.outline = std::move(outline).value();
  return out;
}

TriangleMesh make_fluted_mesh(const ToolSpec& as_filed) {
  const ToolSpec spec = as_drawn(as_filed);
  const CuttingEdges edges = find_cutting_edges(spec);
  const std::vector<Vec3> teeth = saw_teeth(spec);
  if (edges.count == 0 && teeth.empty()) return make_tool_mesh(spec);
  ToolSpec boxes = spec;
  if (!teeth.empty())
    std::erase_if(boxes.regions, [](const RegionSpec& region) { return !region.solid.revolves() && region.erosion.base > 0.0; });
  if (edges.count > 0) boxes.outline.clear();
  TriangleMesh mesh = make_tool_mesh(boxes);
  append_creased(mesh, teeth);
  if (edges.count == 0) return mesh;
  append_creased(mesh, FlutedBit(spec, edges).triangles());
  return mesh;
}

}  // namespace burrhole
