#include "core/contact/surface_view.h"

namespace burrhole {
namespace {

template <class Record>
const Record* first_of(const RecordArray& records) noexcept {
  const auto* array = std::get_if<std::vector<Record>>(&records);
  return array != nullptr && !array->empty() ? array->data() : nullptr;
}

}  // namespace

RecordView record_view(const ContactWindow& window, const Affine& bone_from_index) noexcept {
  return {window.box,      window.records_valid, first_of<Record8>(window.records), first_of<Record16>(window.records),
          bone_from_index, window.records_cut};
}

std::optional<SurfaceView> surface_view(const ContactWindow& window, const Affine& bone_from_index, const Pose& world_from_bone,
                                        const CoarseDistance* coarse) noexcept {
  const RecordView records = record_view(window, bone_from_index);
  if (records.records8 == nullptr && records.records16 == nullptr) return std::nullopt;
  return SurfaceView{records, window.stiffness.data(), world_from_bone, coarse};
}

}  // namespace burrhole
