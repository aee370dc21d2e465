#include "core/drill/removal_rate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <vector>

#include "core/base/bounds.h"

namespace burrhole {
namespace {

constexpr double kLeastFacing = 0.1;  // [-] cosine: a wall along the feed neither limits the feed nor is cut by it

/// Coordinates of a feed: u and v across it, w along it, backwards from the leading end.
struct FeedFrame {
  std::size_t u, v, w;
  double back;  ///< [-] sign of w along its tool axis

  [[nodiscard]] double behind(const Vec3& p) const noexcept { return back * p[w]; }
};

FeedFrame frame_of(FeedDirection direction) noexcept {
  return direction == FeedDirection::plunge ? FeedFrame{0, 1, 2, 1.0} : FeedFrame{1, 2, 0, -1.0};
}

/// Erosion points by column of the lattice along the feed.
class Columns {
 public:
  Columns(const ErosionPoints& points, const FeedFrame& frame) : frame_(frame), pitch_(points.pitch) {
    for (std::size_t n = 0; n < points.size(); ++n) {
      const Vec3& p = points.positions[n];
      cells_[key(cell(p[frame.u]), cell(p[frame.v]))].push_back({p, static_cast<double>(points.factors[n])});
    }
  }
  [[nodiscard]] double pitch() const noexcept { return pitch_; }
  [[nodiscard]] double area() const noexcept { return static_cast<double>(cells_.size()) * pitch_ * pitch_; }
  /// @returns the factor [1/rev] of the nearest erosion point within a pitch along each axis; 0 if there is none.
  [[nodiscard]] double factor(const Vec3& q) const {
    double nearest = std::numeric_limits<double>::infinity(), out = 0.0;
    each_near(q, [&](const Cell& one) {
      const Vec3 away = one.position - q;
      if (std::abs(away[frame_.w]) > pitch_ || !(glm::dot(away, away) < nearest)) return;
      nearest = glm::dot(away, away);
      out = one.factor;
    });
    return out;
  }
  /// @returns whether something cuts ahead of q, at least `lag` [m] away.
  [[nodiscard]] bool cut_ahead(const Vec3& q, double lag) const {
    bool out = false;
    each_near(q, [&](const Cell& one) { out = out || frame_.behind(one.position) - 0.5 * pitch_ <= frame_.behind(q) - lag; });
    return out;
  }

 private:
  struct Cell {
    Vec3 position;
    double factor;
  };
  [[nodiscard]] long long cell(double x) const noexcept { return static_cast<long long>(std::floor(x / pitch_)); }
  [[nodiscard]] static long long key(long long i, long long j) noexcept { return i * (1LL << 31) + j; }
  /// Calls `use` for the cells of the column of q and of the eight beside it.
  template <class Use>
  void each_near(const Vec3& q, const Use& use) const {
    const long long i = cell(q[frame_.u]), j = cell(q[frame_.v]);
    for (long long a = i - 1; a <= i + 1; ++a)
      for (long long b = j - 1; b <= j + 1; ++b)
        if (const auto found = cells_.find(key(a, b)); found != cells_.end())
          for (const Cell& one : found->second) use(one);
  }

  FeedFrame frame_;
  double pitch_;
  std::unordered_map<long long, std::vector<Cell>> cells_;
};

/// Factors [1/rev] at the place of a face: at the place itself, and at the corners of a voxel round it.
struct FaceFactors {
  double low = 0.0, high = 0.0;
  bool layered = false;  // the factor at the surface of the tool differs from that at the face, deeper inside
  [[nodiscard]] double middle() const noexcept { return 0.5 * (low + high); }
};

FaceFactors factors_at(const Columns& columns, const FeedFrame& frame, const Vec3& face, double voxel_edge) {
  const double near = columns.factor(face);
  double sum = 0.0;
  int count = 0;
  // A corner may lie between lattice cells: the mean of those round it.
  const double corner = 0.5 * voxel_edge, beside = 0.25 * columns.pitch();
  for (const double a : {-corner - beside, beside - corner, corner - beside, corner + beside})
    for (const double b : {-corner - beside, beside - corner, corner - beside, corner + beside}) {
      Vec3 place = face;
      place[frame.u] += a;
      place[frame.v] += b;
      if (const double factor = columns.factor(place); factor > 0.0) sum += factor, ++count;
    }
  if (count == 0 || !(sum / count > near)) return {.low = near, .high = near};
  // The nearest erosion point may be half a lattice cell aside, where a factor that rises with the radius is higher: extrapolated.
  const double high = sum / count;
  return {.low = std::max(0.0, 2.0 * near - high), .high = high};
}

/// [m] of the foremost cutting point, backwards along the feed.
double leading_end(const Tool& tool, const FeedFrame& frame) {
  double lead = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < tool.shell.size(); ++n)
    if (tool.shell.cutting[n] != 0) lead = std::min(lead, frame.behind(tool.shell.positions[n]));
  return lead;
}

/// Whether the rim of a flat end rests on the fillet between floor and wall: points of the wall are too far from those of the end for
/// contact to round the edge between them.
bool has_coarse_rim(const Tool& tool, const FeedFrame& frame, double voxel_edge) {
  constexpr double kEnd = 0.95, kWall = 0.8, kReach = 6.0;  // [-] cosines; [voxels] in which faces of an edge are found
  const double lead = leading_end(tool, frame);
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < tool.shell.size(); ++n) {
    const Vec3& wall = tool.shell.positions[n];
    if (tool.shell.cutting[n] == 0 || std::abs(tool.shell.inward_normals[n][frame.w]) > kWall) continue;
    if (frame.behind(wall) > lead + voxel_edge) continue;
    for (std::size_t m = 0; m < tool.shell.size(); ++m)
      if (tool.shell.cutting[m] != 0 && frame.back * tool.shell.inward_normals[m][frame.w] > kEnd)
        nearest = std::min(nearest, glm::length(tool.shell.positions[m] - wall));
  }
  return std::isfinite(nearest) && nearest > kReach * voxel_edge;
}

/// Whether the leading end is a point: within a voxel of it the faces are oblique.
bool is_pointed(const Tool& tool, const FeedFrame& frame, double voxel_edge) {
  constexpr double kOblique = 0.9;  // [-] cosine; a ball of three voxels is less oblique so near to its pole
  const double lead = leading_end(tool, frame);
  bool oblique = false, flat = false;
  for (std::size_t n = 0; n < tool.shell.size(); ++n) {
    if (tool.shell.cutting[n] == 0 || frame.behind(tool.shell.positions[n]) > lead + voxel_edge) continue;
    const double facing = frame.back * tool.shell.inward_normals[n][frame.w];
    oblique = oblique || (facing > kLeastFacing && facing < kOblique);
    // The apex itself may face the feed.
    flat =
        flat || (facing >= kOblique && std::hypot(tool.shell.positions[n][frame.u], tool.shell.positions[n][frame.v]) > 0.25 * voxel_edge);
  }
  return oblique && !flat;
}

/// [m] largest depth of engagement for which the prediction holds: half the width of the cutting part, or half the height of a point.
double deepest_lag(const Tool& tool, const FeedFrame& frame, bool pointed) {
  const auto [lo, hi] = bounds_of_points(tool.erosion.positions);
  double height = 0.0;
  const double lead = leading_end(tool, frame);
  for (std::size_t n = 0; n < tool.shell.size(); ++n)
    if (tool.shell.cutting[n] != 0 && frame.back * tool.shell.inward_normals[n][frame.w] > kLeastFacing)
      height = std::max(height, frame.behind(tool.shell.positions[n]) - lead);
  const double width = tool.erosion.pitch + std::min(hi[frame.u] - lo[frame.u], hi[frame.v] - lo[frame.v]);
  return 0.5 * (pointed ? std::min(width, height) : width);
}

/// @returns why a speed is not known to 10 %; empty: it is.
std::string why_unknown(const Tool& tool, const FeedFrame& frame, const FeedPrediction& feed, bool layered,
                        const FeedConditions& conditions) {
  constexpr double kKnown = 0.1;  // [-] of the middle of the range
  const double spread = (feed.most - feed.least) / (feed.most + feed.least);
  if (spread > kKnown)
    return "the erosion factor changes within a voxel of the slowest place, so the feed depends on where the axis lies between voxels";
  if (layered) return "the engaged depth is over the skin of the tool, and the erosion factor changes below it";
  if (has_coarse_rim(tool, frame, conditions.voxel_edge)) return "the shell points of the rim are too far apart for its edge to be rounded";
  const bool pointed = is_pointed(tool, frame, conditions.voxel_edge);
  if (feed.engaged > deepest_lag(tool, frame, pointed)) return "the engaged depth is over half of the width of the end or of its point";
  if (pointed && feed.engaged < conditions.voxel_edge)
    return "the end is pointed and engaged by less than a voxel, which does not resolve the point";
  return {};
}

}  // namespace

FeedPrediction predict_feed(const Tool& tool, FeedDirection direction, const FeedConditions& conditions) {
  FeedPrediction out;
  out.engaged = conditions.thrust / conditions.cutting_stiffness;
  if (tool.erosion.size() == 0) return out;
  const FeedFrame frame = frame_of(direction);
  const Columns columns(tool.erosion, frame);
  out.area = columns.area();
  const double half = 0.5 * tool.erosion.pitch;
  // Sorted by k first: the ends of the list are the lowest and the highest layer.
  const double low = tool.erosion.positions.front().z - half, high = tool.erosion.positions.back().z + half;
  FaceFactors least{.low = std::numeric_limits<double>::infinity(), .high = std::numeric_limits<double>::infinity()};
  for (std::size_t n = 0; n < tool.shell.size(); ++n) {
    const Vec3 &p = tool.shell.positions[n], &inward = tool.shell.inward_normals[n];
    const double facing = frame.back * inward[frame.w];
    // Passive parts that touch the cutting part from above or below are clear of bone too.
    const double skin = tool.shell.cutting[n] != 0 ? 0.0 : half;
    const bool clear = p.z > high - skin || (direction == FeedDirection::sideways && p.z < low + skin);
    if (facing < kLeastFacing || clear) continue;
    if (tool.shell.cutting[n] == 0) {
      if (!columns.cut_ahead(p, out.engaged)) least = {};
      continue;
    }
    Vec3 face = p;  // where the face of bone is: the whole cutting part is engaged by one distance back along the push
    face[frame.w] += frame.back * out.engaged;
    // A part that is thinner than the lag cuts with its whole thickness.
    const double inside = columns.factor(face), surface = columns.factor(p);
    FaceFactors factors = factors_at(columns, frame, inside > 0.0 ? face : p, conditions.voxel_edge);
    factors.layered = inside > 0.0 && surface > 0.0 && std::abs(inside - surface) > 0.1 * std::max(inside, surface);
    if (factors.middle() < least.middle()) least = factors;
  }
  if (!std::isfinite(least.low)) return out;
  const double by_factor = out.engaged * conditions.spin / conditions.hardness;
  out.speed = least.middle() * by_factor;
  out.least = least.low * by_factor;
  out.most = least.high * by_factor;
  out.rate = out.area * out.speed;
  if (out.speed > 0.0) out.unknown = why_unknown(tool, frame, out, least.layered, conditions);
  if (out.speed > 0.0 && direction == FeedDirection::sideways && out.unknown.empty()) out.unknown = "feeds to the side are not measured";
  return out;
}

double feed_beside_pore(const Tool& tool) noexcept {
  constexpr double kPore = 0.35e-3;  // [m] radius of a pore of the diploe, in which nothing is cut
  double within = std::numeric_limits<double>::infinity(), beside = within;
  for (std::size_t n = 0; n < tool.erosion.size(); ++n) {
    const Vec3& p = tool.erosion.positions[n];
    const double r = std::hypot(p.x, p.y);
    double& least = r < kPore ? within : beside;
    if (r < 2.0 * kPore && tool.erosion.factors[n] > 0.0f) least = std::min(least, static_cast<double>(tool.erosion.factors[n]));
  }
  return std::isfinite(within) && std::isfinite(beside) ? std::max(1.0, beside / within) : 1.0;
}

}  // namespace burrhole
