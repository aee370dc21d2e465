/// app/render/triangle_chunks.h: places for the triangles of a mesh such that neighbours stand together, and which of them a part of a picture
///   can show, so that only those are drawn. No OpenGL. Internal to app/render.
///   Frame  bone frame.   Units  m; pixels.   Errors  none.   Thread  one owner.
#pragma once

#include <cstdint>
#include <vector>

#include "app/render/footprint.h"
#include "app/view/bone_mesh.h"

namespace burrhole {

/// Each number of a triangle has a place. Numbers follow the pivoting, in long strips; places follow a curve that fills space (Morton), so that
/// a box round kTriangles adjacent places is small. A removed triangle leaves number and place to one that is mostly nearby.
class TriangleChunks {
 public:
  static constexpr std::uint32_t kTriangles = 256;

  /// Gives each number a place, along the curve, and notes all triangles.
  void arrange(const BoneMesh& mesh);
  /// Gives numbers up to `triangles` the places behind the others.
  void extend(std::uint32_t triangles);
  [[nodiscard]] std::uint32_t place_of(std::uint32_t number) const { return places_[number]; }
  [[nodiscard]] std::uint32_t number_at(std::uint32_t place) const { return numbers_[place]; }
  /// Notes where the triangle of a place is; with three equal corners it is nowhere.
  void set(std::uint32_t place, const MeshTriangle& triangle);
  /// @returns the places of triangles that pixels of a part may show, and of few others, increasing; valid until the next call.
  [[nodiscard]] const std::vector<TriangleRange>& find(const CameraRays& rays, const Affine& world_from_bone, const PixelRect& part,
                                                       const Vec2i& picture);

 private:
  struct Chunk {
    Vec3f lo{0.0f}, hi{0.0f};  // [m]
    bool empty = true, stale = true;
  };
  void measure(std::size_t chunk);

  std::vector<std::uint32_t> places_, numbers_;  // of each number, at each place
  std::vector<Vec3f> lowest_;                    // [m] by place, lowest coordinates of its triangle; NaN where there is none
  Vec3f longest_{0.0f};                          // [m] of all triangles so far, along each axis
  std::vector<Chunk> chunks_;
  std::vector<TriangleRange> found_;
};

}  // namespace burrhole
