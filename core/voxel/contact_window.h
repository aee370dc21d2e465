/// core/voxel/contact_window.h: the published copy of the master window that contact reads, with the fields that it requires. A copy always
/// holds complete simulation steps.
///   Frame  index; records as surface_records.h.   Errors  none.   Thread  publisher: simulation; copies: contact.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/snapshot_buffer.h"
#include "core/voxel/contact_words.h"
#include "core/voxel/surface_records.h"
#include "core/voxel/triangle_patch.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Fields that a reader requires; other fields stay empty and cost nothing.
struct ContactFields {
  bool density = true;                          ///< for trilinear samples: the 0.5 surface, the drill monitor
  bool gradient = true;                         ///< float gradients, computed from the master's density when a copy is updated
  bool words = false;                           ///< packed density and gradient, for the SIMD gradient-plane model
  std::optional<RecordPrecision> records = {};  ///< distance and normal of the surface, with stiffness, for the constrained tool
  LabelFactors label_stiffness = kAllAlike;     ///< [-] 0..1 for each label: scales the stiffness
  MakeTriangles triangles = nullptr;            ///< triangles of the surface, for the mesh model; null: none
};

/// @returns whether a slide of the window reads labels.
[[nodiscard]] inline bool needs_labels(const ContactFields& fields) noexcept {
  return fields.records && fields.label_stiffness != kAllAlike;
}

/// @returns the bytes per voxel of one copy, without triangles.
[[nodiscard]] constexpr std::size_t bytes_a_voxel(const ContactFields& fields) noexcept {
  std::size_t sum = 0;
  if (fields.density) sum += sizeof(float);
  if (fields.gradient) sum += sizeof(Vec3f);
  if (fields.words) sum += sizeof(ContactWord);
  if (fields.records) sum += sizeof(std::uint8_t) + (*fields.records == RecordPrecision::bits8 ? sizeof(Record8) : sizeof(Record16));
  return sum;
}

/// Dense fields over `box`, i fastest; gradient valid inside box.grown(-1).
struct ContactWindow {
  VoxelBox box;
  std::vector<float> density;   ///< [-] 0..1
  std::vector<Vec3f> gradient;  ///< [1/voxel] of the density
  std::vector<ContactWord> words;
  RecordArray records;
  VoxelBox records_valid;               ///< box in which records are valid
  VoxelBox records_cut;                 ///< box of records that may be of the cut surface (cut_surface.h)
  std::vector<std::uint8_t> stiffness;  ///< relative: hardness times the factor of the label, 255 is 1; present with records
  TrianglePatch triangles;              ///< of the surface in `box`
  std::uint64_t window_epoch = 0;
  std::uint64_t growth_epoch = 0;
  std::uint64_t number = 0;  ///< of the publication, from 1

  [[nodiscard]] std::size_t bytes() const noexcept;
};

/// Writer of the copies. It holds three copies, one if one thread writes and reads, and for each the boxes that changed since its last
/// update. Publishing updates one copy and swaps an index. Fields derived from the master window are stored once and copied like the others,
/// so the leaps of a copy always belong to the same step as its density. After a slide of the window, values that remain are moved and new
/// ones are copied.
/// Thread: publish() by the simulation; exchange().latest() by contact.
class ContactWindowPublisher {
 public:
  /// Registers itself as a listener of `voxmap`, whose window must be placed. @param one_thread one thread calls publish() and
  /// exchange().latest(): one copy is kept instead of three, and what latest() returned changes with the next publish().
  explicit ContactWindowPublisher(Voxmap& voxmap, const ContactFields& fields = {}, bool one_thread = false);

  void publish(Voxmap& voxmap);
  /// Reserves memory for windows of up to `window_voxels`, so that sliding allocates nothing. Call before the reader starts.
  void reserve(std::size_t window_voxels);
  [[nodiscard]] SnapshotBuffer<ContactWindow>& exchange() noexcept { return buffer_; }
  [[nodiscard]] const ContactFields& fields() const noexcept { return fields_; }
  /// Window epoch of the newest published copy.
  [[nodiscard]] std::uint64_t published_epoch() const noexcept { return published_epoch_; }
  [[nodiscard]] std::uint64_t published() const noexcept { return published_; }  ///< number of publications
  [[nodiscard]] std::uint64_t copied_voxels() const noexcept { return copied_voxels_; }
  /// @returns the memory of the copies and of the derived fields.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  template <class F>
  void for_each_field(ContactWindow& copy, const MasterWindow& master, F&& f);
  void follow_window(const Voxmap& voxmap);
  void load_window(const Voxmap& voxmap);
  void slide_window(const Voxmap& voxmap);
  void find_stiffness(const Voxmap& voxmap, const VoxelBox& part);
  void note(const VoxelBox& changed);
  void catch_up(ContactWindow& copy, VoxelBoxes& missed, const Voxmap& voxmap);

  std::size_t listener_;
  ContactFields fields_;
  ContactWords words_;
  std::optional<SurfaceRecords> records_;
  std::unique_ptr<TriangleSource> triangles_;
  std::vector<std::uint8_t> stiffness_;  // of the master, relative, in bytes
  VoxelBox box_;                         // of the master at the last publishing
  SnapshotBuffer<ContactWindow> buffer_;
  std::size_t copies_;  // the first slots of the buffer are in use
  std::array<VoxelBoxes, 3> missed_;
  std::uint64_t published_epoch_ = 0;
  std::uint64_t published_ = 0;
  std::uint64_t growth_epoch_;
  std::uint64_t copied_voxels_ = 0;
};

}  // namespace burrhole
