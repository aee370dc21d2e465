/// core/voxel/contact_window.h: the published copy of the window that contact reads, with those fields that it asked for; never half a
/// step.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/snapshot_buffer.h"
#include "core/voxel/contact_words.h"
#include "core/voxel/surface_records.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// What a reader needs; a field that is not asked for stays empty and costs nothing.
struct ContactFields {
  bool density = true;                          ///< trilinear samples: the 0.5 surface, the drill monitor
  bool gradient = true;                         ///< float gradients, made from the master's density as boxes are caught up
  bool words = false;                           ///< the packed form: gradient-plane by vectors
  std::optional<RecordPrecision> records = {};  ///< distance and normal of the surface, and stiffness beside them: the constrained tool
  LabelFactors label_stiffness = kAllAlike;     ///< 0..1, of bone's labels: scales the stiffness beside records
};

/// Bytes that a voxel of one copy takes.
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
  std::vector<float> density;
  std::vector<Vec3f> gradient;
  std::vector<ContactWord> words;
  RecordArray records;
  VoxelBox records_valid;               ///< where records are true
  std::vector<std::uint8_t> stiffness;  ///< relative: hardness times its label's factor, 255 is 1; beside records
  std::uint64_t window_epoch = 0;
  std::uint64_t growth_epoch = 0;
  std::uint64_t number = 0;  ///< of the publication, from 1

  [[nodiscard]] std::size_t bytes() const noexcept;
};

/// Writer's side: keeps three copies, each with the boxes that it missed; publishing catches one up and swaps an index. Fields that are
/// derived from the master window are kept once and copied like the others, so a copy never holds a leap of another step than its density.
/// A window that slid is caught up by moving what stays and copying what is new.
/// Thread: publish() by the simulation; exchange().latest() by contact.
class ContactWindowPublisher {
 public:
  /// `voxmap` must have its window placed; registers itself as a listener.
  explicit ContactWindowPublisher(Voxmap& voxmap, const ContactFields& fields = {})
      : listener_(voxmap.add_listener()), fields_(fields), growth_epoch_(voxmap.growth_epoch()) {
    if (fields.records) records_.emplace(voxmap.bone().bone_from_index(), *fields.records);
  }

  void publish(Voxmap& voxmap);
  [[nodiscard]] SnapshotBuffer<ContactWindow>& exchange() noexcept { return buffer_; }
  [[nodiscard]] const ContactFields& fields() const noexcept { return fields_; }
  /// Window epoch of the newest copy handed over.
  [[nodiscard]] std::uint64_t published_epoch() const noexcept { return published_epoch_; }
  [[nodiscard]] std::uint64_t published() const noexcept { return published_; }  ///< how many copies were handed over
  [[nodiscard]] std::uint64_t copied_voxels() const noexcept { return copied_voxels_; }
  /// Of the three copies and of the fields kept for them.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  template <class F>
  void for_each_field(ContactWindow& copy, const MasterWindow& master, F&& f);
  void follow_window(const Voxmap& voxmap);
  void load_window(const Voxmap& voxmap);
  void slide_window(const Voxmap& voxmap);
  void find_stiffness(const Voxmap& voxmap, const VoxelBox& part);
  void note(const VoxelBox& changed);
  void catch_up(ContactWindow& copy, DirtyBoxes& missed, const Voxmap& voxmap);

  std::size_t listener_;
  ContactFields fields_;
  ContactWords words_;
  std::optional<SurfaceRecords> records_;
  std::vector<std::uint8_t> stiffness_;  // of the master, relative, in bytes
  VoxelBox box_;                         // of the master at the last publishing
  SnapshotBuffer<ContactWindow> buffer_;
  std::array<DirtyBoxes, 3> missed_;
  std::uint64_t published_epoch_ = 0;
  std::uint64_t published_ = 0;
  std::uint64_t growth_epoch_;
  std::uint64_t copied_voxels_ = 0;
};

}  // namespace burrhole
