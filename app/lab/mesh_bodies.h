/// app/lab/mesh_bodies.h: bodies with a known surface as densities, before and after bone is removed from a box of 20^3 voxels.
///   Density   0.5 - d / (2 w), clamped to 0..1, as phantom.h: d the signed distance, w = |nx| + |ny| + |nz| of the normal.
///   Frame  index.   Units  voxels.   Errors  those of a phantom.   Thread  one.
#pragma once

#include <string>
#include <vector>

#include "app/lab/mesh_measures.h"
#include "core/base/result.h"
#include "core/voxel/gradient.h"

namespace burrhole {

inline constexpr int kRemovedEdge = 20;  ///< [voxels] of the box in which bone is removed

struct MeshBody {
  std::string name;
  std::string truth;  ///< what its surface is
  VoxelBox box;
  std::vector<float> before, after;  ///< [-] dense, i fastest; they differ in `changed` only
  VoxelBox changed;
  KnownSurface surface{};  ///< after
  double volume = 0.0;     ///< [voxel^3] after
  [[nodiscard]] DensityBlock block_before() const { return {box, before}; }
  [[nodiscard]] DensityBlock block_after() const { return {box, after}; }
};

/// Names of the bodies, in the order of the tables.
[[nodiscard]] std::vector<std::string> mesh_body_names();
/// Three closed forms in a general position: before, the box is solid.
///   ball    of radius 15.
///   slab    tilted, 45 x 45 x 16.4, with a round hole of radius 8.4 through its middle.
///   cavity  of radius 10 in a ball of radius 20.
/// And `patch`: the skull phantom at 0.5 mm, from which a burr of radius 8 voxels is removed. Its truth is the 0.5 level of the trilinear density.
/// @param name of mesh_body_names().
[[nodiscard]] Result<MeshBody> make_mesh_body(const std::string& name);

/// A wavy plate of bone in a box of edge^3 voxels, whose middle is the same for all edges, to the last bit: the models of which times are compared.
struct MeshModel {
  VoxelBox box;
  std::vector<float> density;  ///< [-] dense, i fastest; as before() or after() left it
  VoxelBox changed;
  std::vector<float> box_before{}, box_after{};  ///< [-] densities of `changed`
  [[nodiscard]] DensityBlock block() const { return {box, density}; }
  void set_before() { set(box_before); }
  void set_after() { set(box_after); }

 private:
  void set(const std::vector<float>& values);
};
/// @param edge [voxels] at least 40
[[nodiscard]] MeshModel make_mesh_model(int edge);

}  // namespace burrhole
