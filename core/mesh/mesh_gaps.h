/// core/mesh/mesh_gaps.h: signed distances of a tool's points from the triangles of the surface, for the tool that the mesh constrains.
///   Method  A point that was found apart from bone is not searched again before the tool has moved it as far as its distance. Bone that is
///           removed only makes distances larger; where bone comes back, forget().
///   Frame   bone.   Units  SI.   Errors  none.   Thread  contact; never allocates after construction.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/assert.h"
#include "core/contact/contact_view.h"

namespace burrhole {

/// A point near the surface.
struct MeshGap {
  std::uint32_t point = 0;
  double gap = 0.0;  ///< [m] signed distance, < 0 in bone
  Vec3 normal{0.0};  ///< [-] unit: the gradient of the distance; zero where bone is deep and no triangle is near
};

class MeshGaps {
 public:
  static constexpr double kSearch = 3.0;  ///< [voxel edges] a triangle farther off is not searched
  /// @param points of the shell. @param edge [m] of a voxel.
  MeshGaps(std::size_t points, double edge);
  void forget() noexcept;
  /// Starts a list of the points nearer than `reach` [m], at most kSearch voxel edges.
  void begin(const ContactView& bone, double reach) noexcept;
  /// @param place [m] bone frame.
  void probe(std::uint32_t point, const Vec3& place) noexcept BH_REALTIME;

  [[nodiscard]] std::span<const MeshGap> list() const noexcept { return {near_.data(), count_}; }
  [[nodiscard]] double nearest() const noexcept { return nearest_; }  ///< [m] lower bound of the distance of all points outside bone
  [[nodiscard]] bool outside() const noexcept { return outside_; }    ///< a point was outside the window
  /// @returns the number of a point in list(); list().size() where it is not there.
  [[nodiscard]] std::size_t find(std::uint32_t point) const noexcept {
    const std::size_t n = slot_[point];
    return n < count_ && near_[n].point == point ? n : count_;
  }
  /// Raises the gaps of the points for which which(point) is true to at least `least` [m].
  template <class Which>
  void bound(double least, Which&& which) noexcept {
    for (std::size_t n = 0; n < count_; ++n)
      if (near_[n].gap < least && which(near_[n].point)) near_[n].gap = least;
  }

 private:
  struct Known {
    Vec3 place{0.0};
    double distance = 0.0;  // [m] lower bound outside bone; 0: unknown or inside
  };
  void add(const MeshGap& gap) noexcept;

  double edge_;
  double reach_ = 0.0, nearest_ = 0.0;
  bool outside_ = false;
  const ContactView* bone_ = nullptr;
  Affine index_from_bone_;
  std::uint64_t layout_ = 0;
  std::vector<Known> known_;
  std::vector<MeshGap> near_;
  std::vector<std::uint32_t> slot_;
  std::size_t count_ = 0;
};

}  // namespace burrhole
