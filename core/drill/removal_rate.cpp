#include "core/drill/removal_rate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
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
      cells_[key(cell(p[frame.u]), cell(p[frame.v]))].push_back({frame.behind(p), static_cast<double>(points.factors[n])});
    }
  }
  [[nodiscard]] double area() const noexcept { return static_cast<double>(cells_.size()) * pitch_ * pitch_; }
  /// Integral of the factor along the feed up to q [m/rev], of the richest column within a pitch of q: a voxel, normally two pitches wide,
  /// averages over this distance, and a rim cuts with the cells beside it.
  [[nodiscard]] double exposure(const Vec3& q) const {
    const long long i = cell(q[frame_.u]), j = cell(q[frame_.v]);
    double most = 0.0;
    for (long long a = i - 1; a <= i + 1; ++a)
      for (long long b = j - 1; b <= j + 1; ++b) most = std::max(most, column(key(a, b), q));
    return most;
  }

 private:
  struct Cell {
    double behind, factor;
  };
  [[nodiscard]] long long cell(double x) const noexcept { return static_cast<long long>(std::floor(x / pitch_)); }
  [[nodiscard]] static long long key(long long i, long long j) noexcept { return i * (1LL << 31) + j; }
  [[nodiscard]] double column(long long at, const Vec3& q) const {
    const auto found = cells_.find(at);
    if (found == cells_.end()) return 0.0;
    double sum = 0.0;
    for (const Cell& one : found->second) sum += one.factor * std::clamp(frame_.behind(q) - one.behind + 0.5 * pitch_, 0.0, pitch_);
    return sum;
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
    Vec3 gone = p;  // position where bone must be gone: the whole cutting part is engaged by one distance back along the push
    if (tool.shell.cutting[n] != 0) gone[frame.w] += frame.back * out.engaged;
    least = std::min(least, columns.exposure(gone));
  }
  if (std::isfinite(least)) out.speed = least * conditions.spin / (conditions.hardness * std::numbers::ln2);
  out.rate = out.area * out.speed;
  return out;
}

}  // namespace burrhole
