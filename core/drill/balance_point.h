/// core/drill/balance_point.h: where bone is before the cutting surface of a bit: the mean of the places that meet it.
///   Frame  tool frame; poses are index from tool.   Units  SI.   Errors  none.   Thread  simulation; measure() does not allocate.
///   Source [Petersik03] section 3.4, eq. 1: b = sum of A_i / c over the c places A_i that collide. There they are seen from the middle of a
///          burr; here from the mean of all places. A place collides where the density half a voxel before it is at least 0.5.
///   Limits The paper divides by |b|, which has no direction where bone is all round the bit. Here the direction has a length: 1 where |b| is
///          at least kLeast of the radius of the places, falling to 0 with |b| below.
#pragma once

#include <vector>

#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

struct Balance {
  Vec3 towards{0.0};        ///< [-] length 0 to 1, from the middle of the bit to the balance point
  std::uint32_t count = 0;  ///< places that collide
};

class BalancePoint {
 public:
  static constexpr double kLeast = 0.05;            ///< [-] of the radius, own choice
  static constexpr std::size_t kMostPlaces = 1024;  ///< of more, every n-th is taken

  explicit BalancePoint(const Tool& tool);

  /// Bone outside the window counts as none.
  [[nodiscard]] Balance measure(const MasterWindow& window, const Affine& index_from_tool) const noexcept;
  [[nodiscard]] std::size_t places() const noexcept { return places_.size(); }

 private:
  struct Place {
    Vec3 at;       // [m]
    Vec3 outward;  // [-] unit
  };
  std::vector<Place> places_;
  Vec3 middle_{0.0};     // [m]
  double radius_ = 0.0;  // [m] mean distance of the places from it
};

}  // namespace burrhole
