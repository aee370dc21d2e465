/// tests/core/drill/drill_cases.h: blocks of bone, tools as plain lattices of points, and a slow plain twin of erosion.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "core/drill/erosion.h"

namespace burrhole::test {

/// A block of even bone with its window round all of it, two voxels wider than may be eroded.
struct Block {
  Vec3i dims{24};
  double pitch = 0.5e-3;  ///< [m]
  float occupancy = 1.0f;
  float hardness = 1.0f;
  [[nodiscard]] Voxmap make() const;
};
/// The same, but with occupancy and hardness of each voxel at random (occupancy a fifth 0, a fifth 1).
[[nodiscard]] Voxmap random_block(const Vec3i& dims, double pitch, std::uint64_t seed);
[[nodiscard]] Voxmap voxmap_of(const DenseBone& dense);

/// Solids in the tool frame, as make_erosion_points has them: tip at the origin, +z up the shaft.
struct Cylinder {
  double radius, height;  // [m]
  [[nodiscard]] bool holds(const Vec3& p) const;
};
struct Ball {
  double radius;  // [m]; centre at (0, 0, radius)
  [[nodiscard]] bool holds(const Vec3& p) const;
};
/// Cell centres of a lattice of that pitch inside the solid, k, j, i, one factor for all.
[[nodiscard]] ErosionPoints lattice(const std::function<bool(const Vec3&)>& holds, double reach, double pitch, float factor);
[[nodiscard]] ErosionPoints lattice(const Cylinder& solid, double pitch, float factor);
[[nodiscard]] ErosionPoints lattice(const Ball& solid, double pitch, float factor);
/// The eight points, at +- a quarter of a voxel, of one voxel.
[[nodiscard]] ErosionPoints one_voxel(double voxel_pitch, float factor);

[[nodiscard]] Erosion make_erosion(const ErosionPoints& points, const ErosionConfig& config = {});

/// A turned tool pose: no lattice plane parallel to a voxel plane. `tip` in index coordinates.
[[nodiscard]] Affine turned_pose(double voxel_pitch, const Vec3& tip, std::uint64_t seed);
/// A tool pose along the grid's axes.
[[nodiscard]] Affine upright_pose(double voxel_pitch, const Vec3& tip);
[[nodiscard]] Affine moved(const Affine& pose, const Vec3& by);  ///< by [voxels]
/// Does step n of `steps` along a way [voxels] from `start`, at spin 1, and commits it.
void drill_step(Voxmap& voxmap, Erosion& erosion, const Affine& start, const Vec3& way, int n, int steps);
void bring_back(Voxmap& voxmap);  ///< all bone, as an undo does

struct Drilling {
  double mass = 0.0;  ///< [m^3]
  std::uint64_t touched = 0, outside = 0, substeps = 0;
};
/// `steps` steps along the straight path, commits included.
Drilling drill(Voxmap& voxmap, Erosion& erosion, const ErosionPath& path, double spin, double duration, int steps);

/// Integral of occupancy x (1 - remaining) over the window [m^3], summed plainly.
[[nodiscard]] double missing_mass(const Voxmap& voxmap);

/// Erosion from its definition in double: every point, every sub-step, voxels kept in a map. Knows nothing of windows.
class PlainErosion {
 public:
  PlainErosion(const Voxmap& voxmap, const ErosionPoints& points, const ErosionConfig& config);
  void step(const ErosionPath& path, int substeps, double spin, double dt);

  using Key = std::tuple<int, int, int>;
  struct Cell {
    double remaining = 1.0;
    bool at_threshold = false;  ///< was once within float rounding of the minimum density: may fall a sub-step apart
  };
  [[nodiscard]] const std::map<Key, Cell>& cells() const { return cells_; }  ///< every voxel with bone that a point met
  [[nodiscard]] int on_a_face() const { return on_a_face_; }                 ///< points within 1e-9 voxel of a face: could fall either way
  [[nodiscard]] std::uint64_t met() const { return met_; }                   ///< points x sub-steps

 private:
  const Voxmap* voxmap_;
  ErosionPoints points_;
  ErosionConfig config_;
  std::map<Key, Cell> cells_;
  int on_a_face_ = 0;
  std::uint64_t met_ = 0;
};

/// Largest difference of remaining between window and twin over all voxels but those at the threshold, and how many those are.
struct TwinComparison {
  double worst = 0.0;
  int at_threshold = 0;
  int cleared = 0, differently_cleared = 0;  ///< threshold voxels included
};
[[nodiscard]] TwinComparison compare(const Voxmap& voxmap, const PlainErosion& twin);

}  // namespace burrhole::test
