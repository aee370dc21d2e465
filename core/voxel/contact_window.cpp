#include "core/voxel/contact_window.h"

#include "core/voxel/box_parts.h"

namespace burrhole {
namespace {

template <class T>
std::size_t bytes_of_array(const std::vector<T>& values) noexcept {
  return values.capacity() * sizeof(T);
}

}  // namespace

/// Calls f(field of the copy, where it is copied from) for each field that is kept: the one list of fields.
template <class F>
void ContactWindowPublisher::for_each_field(ContactWindow& copy, const MasterWindow& master, F&& f) {
  if (fields_.density) f(copy.density, master.density);
  if (fields_.gradient) f(copy.gradient, master.gradient);
  if (fields_.words) f(copy.words, words_.words());
  if (!records_) return;
  f(copy.hardness, hardness_);
  std::visit(
      [&](const auto& records) {
        using Array = std::decay_t<decltype(records)>;
        if (!std::holds_alternative<Array>(copy.records)) copy.records = Array{};
        f(std::get<Array>(copy.records), records);
      },
      records_->records());
}

std::size_t ContactWindow::bytes() const noexcept {
  const std::size_t of_records = std::visit([](const auto& array) { return bytes_of_array(array); }, records);
  return bytes_of_array(density) + bytes_of_array(gradient) + bytes_of_array(words) + of_records + bytes_of_array(hardness);
}

std::size_t ContactWindowPublisher::bytes() const noexcept {
  std::size_t sum = words_.bytes() + bytes_of_array(hardness_);
  if (records_) sum += records_->bytes();
  for (const ContactWindow& copy : buffer_.slots()) sum += copy.bytes();
  return sum;
}

void ContactWindowPublisher::note(const VoxelBox& changed) {
  for (DirtyBoxes& missed : missed_) missed.add(changed);
}

void ContactWindowPublisher::follow_window(const Voxmap& voxmap) {
  const MasterWindow& master = voxmap.window();
  const bool anew = box_.empty() || growth_epoch_ != voxmap.growth_epoch();
  if (anew) {
    if (fields_.words) words_.rebuild(master);
    if (records_) records_->rebuild(master);
    // A copy that is over no box is taken whole.
    for (DirtyBoxes& missed : missed_) missed.clear();
    note(master.box);
  } else if (master.box != box_) {
    const VoxelBox kept_records = records_ ? records_->valid_box() : box_;
    if (fields_.words) words_.slide(master);
    if (records_) records_->slide(master);
    int margin = fields_.words ? kWordSlideMargin : 1;
    if (records_) margin = std::max(margin, kept_records.lo.x - box_.lo.x);
    for (const VoxelBox& part : box_without(master.box, kept_by_slide(box_, master.box, margin))) note(part);
  }
  if (records_) {
    hardness_.resize(master.hardness.size());
    for (std::size_t n = 0; n < hardness_.size(); ++n) hardness_[n] = static_cast<std::uint8_t>(master.hardness[n] * 255.0f + 0.5f);
  }
  box_ = master.box;
  growth_epoch_ = voxmap.growth_epoch();
}

void ContactWindowPublisher::publish(Voxmap& voxmap) {
  const MasterWindow& master = voxmap.window();
  if (published_epoch_ != voxmap.window_epoch()) follow_window(voxmap);
  const std::vector<VoxelBox> changed = voxmap.take_dirty(listener_);
  for (const VoxelBox& dirty : changed) {
    note(dirty);
    if (fields_.words) note(words_.update(master, dirty));
  }
  if (records_) {
    // Listeners are told of gradients, which change a voxel further out than density does.
    std::vector<VoxelBox> dense;
    for (const VoxelBox& dirty : changed) dense.push_back(dirty.grown(-1));
    for (const VoxelBox& again : records_->update(master, dense)) note(again);
  }
  const std::size_t slot = buffer_.back_index();
  catch_up(buffer_.back(), missed_[slot], voxmap);
  buffer_.publish();
}

void ContactWindowPublisher::catch_up(ContactWindow& copy, DirtyBoxes& missed, const Voxmap& voxmap) {
  const MasterWindow& master = voxmap.window();
  const bool whole = copy.box.empty();
  for_each_field(copy, master, [&](auto& field, const auto& source) {
    if (whole)
      field = source;
    else if (copy.box != master.box)
      slide_array(copy.box, master.box, field);
  });
  if (whole) {
    copied_voxels_ += master.box.count();
  } else {
    for (const VoxelBox& dirty : missed.boxes()) {
      const VoxelBox part = dirty.intersect(master.box);
      if (part.empty()) continue;
      copied_voxels_ += part.count();
      for_each_field(copy, master,
                     [&](auto& field, const auto& source) { copy_part(part, master.box, source.data(), master.box, field.data()); });
    }
  }
  missed.clear();
  copy.box = master.box;
  if (records_) copy.records_valid = records_->valid_box();
  copy.window_epoch = published_epoch_ = voxmap.window_epoch();
  copy.growth_epoch = voxmap.growth_epoch();
}

}  // namespace burrhole
