/// core/voxel/vdb_contact_grids.h: the paper's storage: density and gradient in OpenVDB grids, probed voxel by voxel. Reference for results
/// and speed of the dense window.
///   Frame   index.   Units  density [-], gradient [1/voxel].   Errors  none.
///   Thread  writer and reader share the grids without locks: lockstep only.
///   Source  [AcostaLiu07] section 2 (each voxel encodes density and density gradient).
#pragma once

#include <memory>

#include "core/voxel/voxmap.h"

namespace burrhole {

class VdbContactGrids {
 public:
  /// Builds both grids from the whole bone; registers itself as a listener of later changes.
  explicit VdbContactGrids(Voxmap& voxmap);
  ~VdbContactGrids();
  VdbContactGrids(const VdbContactGrids&) = delete;
  VdbContactGrids& operator=(const VdbContactGrids&) = delete;

  void update(Voxmap& voxmap);
  // Probes through persistent accessors; one reader only.
  [[nodiscard]] float density(const Vec3i& v) const noexcept;
  [[nodiscard]] Vec3f gradient(const Vec3i& v) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace burrhole
