#include "core/drill/removal_rate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <vector>

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
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < tool.shell.size(); ++n) {
    const Vec3 &p = tool.shell.positions[n], &inward = tool.shell.inward_normals[n];
    const double facing = frame.back * inward[frame.w];
    // Passive parts that touch the cutting part from above or below are clear of bone too.
    const double skin = tool.shell.cutting[n] != 0 ? 0.0 : half;
    const bool clear = p.z > high - skin || (direction == FeedDirection::sideways && p.z < low + skin);
    if (facing < kLeastFacing || clear) continue;
    if (tool.shell.cutting[n] == 0) {
      if (!columns.cut_ahead(p, out.engaged)) least = 0.0;
      continue;
    }
    Vec3 face = p;  // where the face of bone is: the whole cutting part is engaged by one distance back along the push
    face[frame.w] += frame.back * out.engaged;
    // A part that is thinner than the lag cuts with its whole thickness.
    const double factor = columns.factor(face);
    least = std::min(least, factor > 0.0 ? factor : columns.factor(p));
  }
  if (std::isfinite(least)) out.speed = least * out.engaged * conditions.spin / conditions.hardness;
  out.rate = out.area * out.speed;
  return out;
}

}  // namespace burrhole
