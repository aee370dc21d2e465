#include "core/voxel/contact_window.h"

#include <algorithm>
#include <span>

#include "core/voxel/box_parts.h"

namespace burrhole {
namespace {

template <class T>
std::size_t bytes_of_array(const std::vector<T>& values) noexcept {
  return values.size() * sizeof(T);  // memory reserved for a larger window is not resident
}

/// The factor of each voxel's label; a voxel at a face that is labelled as what lies beyond it takes that of the bone beside it.
std::vector<float> label_factors(const Voxmap& voxmap, const VoxelBox& box, const LabelFactors& factors) {
  const VoxelBox wide = box.grown(1);
  std::vector<float> labels(wide.count());
  voxmap.read_labels(wide, labels);
  const auto label_at = [&](const Vec3i& v) { return static_cast<VoxelLabel>(static_cast<int>(labels[wide.offset_of(v)])); };
  std::vector<float> out(box.count(), 1.0f);
  std::size_t n = 0;
  for (int k = box.lo.z; k < box.hi.z; ++k)
    for (int j = box.lo.y; j < box.hi.y; ++j)
      for (int i = box.lo.x; i < box.hi.x; ++i, ++n) {
        const Vec3i v(i, j, k);
        VoxelLabel label = label_at(v);
        for (const Vec3i& step : {Vec3i(-1, 0, 0), Vec3i(1, 0, 0), Vec3i(0, -1, 0), Vec3i(0, 1, 0), Vec3i(0, 0, -1), Vec3i(0, 0, 1)})
          if (!is_felt(label)) label = label_at(v + step);
        if (is_felt(label)) out[n] = factor_of(factors, label);
      }
  return out;
}

}  // namespace

/// Calls f(field of the copy, where it is copied from) for each field that is kept: the one list of fields.
template <class F>
void ContactWindowPublisher::for_each_field(ContactWindow& copy, const MasterWindow& master, F&& f) {
  if (fields_.density) f(copy.density, master.density);
  if (fields_.words) f(copy.words, words_.words());
  if (!records_) return;
  f(copy.stiffness, stiffness_);
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
  return bytes_of_array(density) + bytes_of_array(gradient) + bytes_of_array(words) + of_records + bytes_of_array(stiffness) +
         triangles.bytes();
}

std::size_t ContactWindowPublisher::bytes() const noexcept {
  std::size_t sum = words_.bytes() + bytes_of_array(stiffness_);
  if (records_) sum += records_->bytes();
  if (triangles_) sum += triangles_->bytes();
  for (const ContactWindow& copy : buffer_.slots()) sum += copy.bytes();
  return sum;
}

ContactWindowPublisher::ContactWindowPublisher(Voxmap& voxmap, const ContactFields& fields, bool one_thread)
    : listener_(voxmap.add_listener()), fields_(fields), copies_(one_thread ? 1 : 3), growth_epoch_(voxmap.growth_epoch()) {
  if (fields.records) records_.emplace(voxmap.bone().bone_from_index(), *fields.records);
  if (fields.triangles != nullptr) triangles_ = fields.triangles(voxmap.bone().bone_from_index());
  if (one_thread) buffer_.use_one_slot();
}

void ContactWindowPublisher::reserve(std::size_t window_voxels) {
  const auto reserve_array = [&](auto& array) { array.reserve(window_voxels); };
  if (fields_.words) words_.reserve(window_voxels);
  if (records_) records_->reserve(window_voxels);
  if (records_) stiffness_.reserve(window_voxels);
  for (ContactWindow& copy : std::span(buffer_.slots()).first(copies_)) {
    if (fields_.density) copy.density.reserve(window_voxels);
    if (fields_.gradient) copy.gradient.reserve(window_voxels);
    if (fields_.words) copy.words.reserve(window_voxels);
    if (!records_) continue;
    copy.stiffness.reserve(window_voxels);
    // The copy takes over the form of the records with its first values.
    if (copy.records.index() != records_->records().index()) copy.records = RecordArray(records_->records());
    std::visit(reserve_array, copy.records);
  }
}

void ContactWindowPublisher::note(const VoxelBox& changed) {
  for (VoxelBoxes& missed : std::span(missed_).first(copies_)) missed.add(changed);
}

void ContactWindowPublisher::find_stiffness(const Voxmap& voxmap, const VoxelBox& part) {
  const MasterWindow& master = voxmap.window();
  const bool alike = fields_.label_stiffness == kAllAlike;
  const std::vector<float> factors = alike ? std::vector<float>(part.count(), 1.0f) : label_factors(voxmap, part, fields_.label_stiffness);
  std::size_t n = 0;
  for_each_voxel(part, [&](const Vec3i& v) {
    const std::size_t at = master.box.offset_of(v);
    stiffness_[at] = static_cast<std::uint8_t>(master.hardness[at] * factors[n++] * 255.0f + 0.5f);
  });
}

void ContactWindowPublisher::load_window(const Voxmap& voxmap) {
  const MasterWindow& master = voxmap.window();
  if (fields_.words) words_.rebuild(master);
  if (records_) {
    records_->rebuild(master, &voxmap.cut());
    stiffness_.resize(master.box.count());
    find_stiffness(voxmap, master.box);
  }
  // A copy that is over no box is taken whole.
  for (VoxelBoxes& missed : missed_) missed.clear();
  note(master.box);
}

void ContactWindowPublisher::slide_window(const Voxmap& voxmap) {
  const MasterWindow& master = voxmap.window();
  Vec3i margin(1);  // of gradients; what is packed or searched for depends on voxels further off
  if (fields_.words) {
    words_.slide(master);
    margin = glm::max(margin, Vec3i(kWordSlideMargin));
  }
  if (records_) {
    margin = glm::max(margin, records_->valid_box().lo - records_->box().lo);
    records_->slide(master, &voxmap.cut());
    slide_array(box_, master.box, stiffness_);
    for (const VoxelBox& part : box_without(master.box, box_)) find_stiffness(voxmap, part);
  }
  for (const VoxelBox& part : box_without(master.box, kept_by_slide(box_, master.box, margin))) note(part);
}

void ContactWindowPublisher::follow_window(const Voxmap& voxmap) {
  if (box_.empty() || growth_epoch_ != voxmap.growth_epoch())
    load_window(voxmap);
  else if (voxmap.window().box != box_)
    slide_window(voxmap);
  if (triangles_) triangles_->rebuild(voxmap.window());
  box_ = voxmap.window().box;
  growth_epoch_ = voxmap.growth_epoch();
}

void ContactWindowPublisher::publish(Voxmap& voxmap) {
  const MasterWindow& master = voxmap.window();
  if (published_epoch_ != voxmap.window_epoch()) follow_window(voxmap);
  const VoxelBoxes changed = voxmap.take_dirty(listener_);
  for (const VoxelBox& dirty : changed) {
    note(dirty);
    if (fields_.words) note(words_.update(master, dirty));
    if (triangles_) triangles_->update(master, dirty);
  }
  if (records_) {
    // Dirty boxes include changed gradients, which extend one voxel beyond changed densities.
    std::vector<VoxelBox> dense;
    for (const VoxelBox& dirty : changed) dense.push_back(dirty.grown(-1));
    const auto again = voxmap.cut().empty() ? records_->update(master, dense) : records_->update_cut(voxmap.cut(), dense);
    for (const VoxelBox& box : again) note(box);
  }
  const std::size_t slot = buffer_.back_index();
  catch_up(buffer_.back(), missed_[slot], voxmap);
  buffer_.back().records_cut = voxmap.cut().box();
  buffer_.back().number = ++published_;
  buffer_.publish();
}

void ContactWindowPublisher::catch_up(ContactWindow& copy, VoxelBoxes& missed, const Voxmap& voxmap) {
  const MasterWindow& master = voxmap.window();
  const bool whole = copy.box.empty();
  for_each_field(copy, master, [&](auto& field, const auto& source) {
    if (whole)
      field = source;
    else if (copy.box != master.box)
      slide_array(copy.box, master.box, field);
  });
  if (fields_.gradient && whole)
    copy.gradient.resize(master.box.count());
  else if (fields_.gradient && copy.box != master.box)
    slide_array(copy.box, master.box, copy.gradient);
  if (whole) {
    if (fields_.gradient) derive_gradient(master, master.box, copy.gradient);
    copied_voxels_ += master.box.count();
  } else {
    for (const VoxelBox& dirty : missed.boxes()) {
      const VoxelBox part = dirty.intersect(master.box);
      if (part.empty()) continue;
      copied_voxels_ += part.count();
      if (fields_.gradient) derive_gradient(master, part, copy.gradient);
      for_each_field(copy, master,
                     [&](auto& field, const auto& source) { copy_part(part, master.box, source.data(), master.box, field.data()); });
    }
  }
  if (triangles_) triangles_->bring_up_to_date(copy.triangles);
  missed.clear();
  copy.box = master.box;
  if (records_) copy.records_valid = records_->valid_box();
  copy.window_epoch = published_epoch_ = voxmap.window_epoch();
  copy.growth_epoch = voxmap.growth_epoch();
}

}  // namespace burrhole
