#include "core/voxel/paged_bone.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/voxel/box_parts.h"

namespace burrhole {
namespace {

constexpr float kBone = 0.5f;
constexpr std::size_t kLabels = static_cast<std::size_t>(BoneField::labels);
constexpr std::size_t kFloatUnits = 4;  // of a field of floats; labels take one

std::size_t number(BoneField field) noexcept { return static_cast<std::size_t>(field); }
bool is_stored(std::uint8_t stored, std::size_t field) noexcept { return (stored >> field & 1) != 0; }

template <class T>
bool is_zero(std::span<const T> values, const VoxelBox& box, const VoxelBox& part) noexcept {
  if (values.empty()) return true;
  const auto width = static_cast<std::size_t>(part.size().x);
  for (int k = part.lo.z; k < part.hi.z; ++k)
    for (int j = part.lo.y; j < part.hi.y; ++j) {
      const T* row = &values[box.offset_of({part.lo.x, j, k})];
      bool zero = true;
      for (std::size_t i = 0; i < width; ++i) zero = zero && row[i] == T{0};
      if (!zero) return false;
    }
  return true;
}

bool is_zero(const BoneValues& values, const VoxelBox& box, const VoxelBox& part) noexcept {
  return std::all_of(values.floats.begin(), values.floats.end(), [&](const auto& field) { return is_zero(field, box, part); }) &&
         is_zero(values.labels, box, part);
}

/// Same bits everywhere.
template <class T>
bool is_constant(const std::array<T, kBlockVoxels>& values) noexcept {
  // Bits are compared on purpose. NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
  return std::memcmp(values.data(), values.data() + 1, (kBlockVoxels - 1) * sizeof(T)) == 0;
}

/// Number and box, within the block, of the values that `counts`.
template <class F>
std::pair<std::size_t, VoxelBox> find_part(const BlockValues& values, F&& counts) noexcept {
  std::pair<std::size_t, VoxelBox> out{0, {}};
  std::size_t n = 0;
  for_each_voxel(box_of_block(Vec3i(0)), [&](const Vec3i& v) {
    if (!counts(values[n++])) return;
    ++out.first;
    out.second.include(v);
  });
  return out;
}

}  // namespace

Result<std::unique_ptr<PagedBone>> PagedBone::create(const Vec3i& dims, const BoneStorage& storage) {
  auto file = BoneFile::create(storage);
  if (!file) return file.error();
  return std::unique_ptr<PagedBone>(new PagedBone(dims, std::move(file).value()));
}

PagedBone::PagedBone(const Vec3i& dims, BoneFile file)
    : nodes_size_((dims + (kNodeEdge * kBlockEdge - 1)) / (kNodeEdge * kBlockEdge)), file_(std::move(file)) {
  nodes_.resize(VoxelBox{Vec3i(0), nodes_size_}.count());
}

// ---- index ----

PagedBone::SmallBox PagedBone::pack(const VoxelBox& box) noexcept {
  SmallBox out = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    out |= (static_cast<SmallBox>(box.lo[axis]) | static_cast<SmallBox>(box.hi[axis]) << 4) << (8 * axis);
  return out;
}

VoxelBox PagedBone::unpack(SmallBox packed, const Vec3i& block) noexcept {
  VoxelBox out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.lo[axis] = block[axis] * kBlockEdge + static_cast<int>(packed >> (8 * axis) & 15);
    out.hi[axis] = block[axis] * kBlockEdge + static_cast<int>(packed >> (8 * axis + 4) & 15);
  }
  return out;
}

std::size_t PagedBone::units_of(std::uint8_t stored) noexcept {
  std::size_t out = 0;
  for (std::size_t field = 0; field < kFields; ++field)
    if (is_stored(stored, field)) out += field == kLabels ? 1 : kFloatUnits;
  return out;
}

std::uint64_t PagedBone::offset_of(const Row& row, std::size_t field) noexcept {
  const auto before = static_cast<std::uint8_t>(row.stored & ((1u << field) - 1));
  return kUnit * (std::uint64_t{row.place} + units_of(before));
}

const PagedBone::Row* PagedBone::find(const Vec3i& block) const noexcept {
  const Vec3i node = block >> 3;
  const VoxelBox all{Vec3i(0), nodes_size_};
  if (!all.contains(node)) return nullptr;
  const Node* const rows = nodes_[all.offset_of(node)].get();
  if (rows == nullptr) return nullptr;
  const std::uint32_t row = (*rows)[VoxelBox{Vec3i(0), Vec3i(kNodeEdge)}.offset_of(block & (kNodeEdge - 1))];
  return row == 0 ? nullptr : &rows_[row - 1];
}

PagedBone::Row& PagedBone::make_row(const Vec3i& block) {
  auto& node = nodes_[VoxelBox{Vec3i(0), nodes_size_}.offset_of(block >> 3)];
  if (!node) node = std::make_unique<Node>();
  std::uint32_t& row = (*node)[VoxelBox{Vec3i(0), Vec3i(kNodeEdge)}.offset_of(block & (kNodeEdge - 1))];
  if (row == 0) {
    rows_.emplace_back();
    row = static_cast<std::uint32_t>(rows_.size());
  }
  return rows_[row - 1];
}

template <class F>
void PagedBone::for_each_row(F&& f) const {
  std::size_t n = 0;
  for_each_voxel({Vec3i(0), nodes_size_}, [&](const Vec3i& node) {
    const Node* const rows = nodes_[n++].get();
    if (rows == nullptr) return;
    std::size_t at = 0;
    for_each_voxel({node * kNodeEdge, (node + 1) * kNodeEdge}, [&](const Vec3i& block) {
      if (const std::uint32_t row = (*rows)[at++]; row != 0) f(block, rows_[row - 1]);
    });
  });
}

// ---- writing ----

Status PagedBone::write(const VoxelBox& box, const BoneValues& values) {
  const VoxelBox blocks = blocks_of(box);
  // Most blocks have no bone: they are found on all cores, the others are stored one after another.
  std::vector<std::uint8_t> empty(blocks.count());
  const Vec3i size = blocks.size();
  constexpr std::size_t kLeast = 50'000;  // [voxels] for which a thread is worth starting
  for_each_number(size.y * size.z, box.count() / kLeast + 1, [&](int n) {
    const VoxelBox line{{blocks.lo.x, blocks.lo.y + n % size.y, blocks.lo.z + n / size.y},
                        {blocks.hi.x, blocks.lo.y + n % size.y + 1, blocks.lo.z + n / size.y + 1}};
    for_each_voxel(line, [&](const Vec3i& block) {
      empty[blocks.offset_of(block)] = is_zero(values, box, box.intersect(box_of_block(block))) ? 1 : 0;
    });
  });
  Values now;
  Status status;
  for_each_voxel(blocks, [&](const Vec3i& block) {
    const Row* const row = find(block);
    if (!status.ok() || (row == nullptr && empty[blocks.offset_of(block)] != 0)) return;
    const VoxelBox whole = box_of_block(block), part = box.intersect(whole);
    load(row, block, now);
    for (std::size_t field = 0; field < now.floats.size(); ++field)
      if (!values.floats[field].empty()) copy_part(part, box, values.floats[field].data(), whole, now.floats[field].data());
    if (!values.labels.empty()) copy_part(part, box, values.labels.data(), whole, now.labels.data());
    status = this->status();
    if (status.ok()) status = store(block, now);
  });
  return status;
}

void PagedBone::load(const Row* row, const Vec3i& block, Values& out) const noexcept {
  for (BlockValues& field : out.floats) field.fill(0.0f);
  out.labels.fill(0);
  if (row == nullptr) return;
  const VoxelBox whole = box_of_block(block);
  for (std::size_t field = 0; field < out.floats.size(); ++field) read_block(*row, field, block, whole, whole, out.floats[field].data());
  out.labels.fill(row->label);
  if (is_stored(row->stored, kLabels) && !read_file(offset_of(*row, kLabels), std::as_writable_bytes(std::span(out.labels))))
    out.labels.fill(0);
}

void PagedBone::take_place(Row& row, std::size_t units_before, std::size_t units) {
  if (units == units_before) return;
  if (units_before > 0) free_[units_before].push_back(row.place);
  if (units == 0) return;
  if (std::vector<std::uint32_t>& free = free_[units]; !free.empty()) {
    row.place = free.back();
    free.pop_back();
    return;
  }
  row.place = end_;
  end_ += static_cast<std::uint32_t>(units);
}

Status PagedBone::store(const Vec3i& block, const Values& values) {
  Row& row = make_row(block);
  const std::size_t units_before = units_of(row.stored);
  std::array<std::byte, kMostUnits * kUnit> record;
  std::size_t count = 0;
  row.stored = 0;
  const auto add = [&](std::size_t field, std::span<const std::byte> bytes) {
    row.stored = static_cast<std::uint8_t>(row.stored | 1u << field);
    std::memcpy(record.data() + count, bytes.data(), bytes.size());
    count += bytes.size();
  };
  for (std::size_t field = 0; field < values.floats.size(); ++field) {
    row.constant[field] = values.floats[field][0];
    if (!is_constant(values.floats[field])) add(field, std::as_bytes(std::span(values.floats[field])));
  }
  row.label = values.labels[0];
  if (!is_constant(values.labels)) add(kLabels, std::as_bytes(std::span(values.labels)));

  const auto any = [](float value) { return value != 0.0f; };
  row.box[0] = pack(find_part(values.floats[number(BoneField::occupancy)], any).second);
  row.box[1] = pack(find_part(values.floats[number(BoneField::soft)], any).second);
  const auto [voxels, bone] = find_part(values.floats[number(BoneField::occupancy)], [](float value) { return value >= kBone; });
  row.bone_voxels = static_cast<std::uint16_t>(voxels);
  row.box[2] = pack(bone);
  take_place(row, units_before, units_of(row.stored));
  return count > 0 ? file_.write(kUnit * std::uint64_t{row.place}, std::span(record).first(count)) : Status();
}

// ---- reading ----

bool PagedBone::read_file(std::uint64_t at, std::span<std::byte> out) const noexcept {
  const int error = file_.read(at, out);
  if (error == 0) return true;
  int none = 0;
  error_.compare_exchange_strong(none, error, std::memory_order_relaxed);
  failed_.store(true, std::memory_order_release);
  return false;
}

void PagedBone::read_block(const Row& row, std::size_t field, const Vec3i& block, const VoxelBox& part, const VoxelBox& box,
                           float* out) const noexcept {
  if (!is_stored(row.stored, field))
    return fill_part(part, field == kLabels ? static_cast<float>(row.label) : row.constant[field], box, out);
  // Only the layers that are needed.
  const VoxelBox whole = box_of_block(block), layers{{whole.lo.x, whole.lo.y, part.lo.z}, {whole.hi.x, whole.hi.y, part.hi.z}};
  const std::size_t first = whole.offset_of(layers.lo), count = layers.count();
  const std::size_t width = field == kLabels ? 1 : sizeof(float);
  const std::uint64_t at = offset_of(row, field) + first * width;
  BlockValues values;
  if (field == kLabels) {
    std::array<std::uint8_t, kBlockVoxels> labels;
    if (!read_file(at, std::as_writable_bytes(std::span(labels).first(count)))) return fill_part(part, 0.0f, box, out);
    std::copy_n(labels.begin(), count, values.begin());
  } else if (part == box && part == layers) {
    if (!read_file(at, std::as_writable_bytes(std::span(out, count)))) fill_part(part, 0.0f, box, out);
    return;
  } else if (!read_file(at, std::as_writable_bytes(std::span(values).first(count)))) {
    return fill_part(part, 0.0f, box, out);
  }
  copy_part(part, layers, values.data(), box, out);
}

void PagedBone::read(BoneField field, const VoxelBox& box, std::span<float> out) const noexcept {
  BH_ASSERT(out.size() == box.count());
  for_each_voxel(blocks_of(box), [&](const Vec3i& block) {
    const VoxelBox part = box.intersect(box_of_block(block));
    if (const Row* const row = find(block))
      read_block(*row, number(field), block, part, box, out.data());
    else
      fill_part(part, 0.0f, box, out.data());
  });
}

float PagedBone::value(BoneField field, const Vec3i& v) const noexcept {
  float out = 0.0f;
  read(field, {v, v + 1}, {&out, 1});
  return out;
}

void PagedBone::for_each_region(BoneField field, const std::function<void(const VoxelBox&)>& f) const {
  BH_ASSERT(field == BoneField::occupancy || field == BoneField::soft);
  const std::size_t which = field == BoneField::soft ? 1 : 0;
  for_each_row([&](const Vec3i& block, const Row& row) {
    if (const VoxelBox box = unpack(row.box[which], block); !box.empty()) f(box);
  });
}

PagedBone::Part PagedBone::bone() const {
  Part out;
  for_each_row([&](const Vec3i& block, const Row& row) {
    out.voxels += row.bone_voxels;
    out.box = out.box.unite(unpack(row.box[2], block));
  });
  return out;
}

Status PagedBone::status() const {
  return failed_.load(std::memory_order_acquire) ? Status(file_.read_error(error_.load(std::memory_order_relaxed))) : Status();
}

// ---- memory ----

std::size_t PagedBone::bytes() const noexcept {
  std::size_t sum = sizeof(PagedBone) + nodes_.capacity() * sizeof(nodes_[0]) + rows_.size() * sizeof(Row);
  for (const auto& node : nodes_) sum += node ? sizeof(Node) : 0;
  for (const auto& places : free_) sum += places.capacity() * sizeof(std::uint32_t);
  return sum;
}

namespace {

/// [-] Blocks of a grid, the last ones of each axis whole.
double blocks_in(const Vec3i& dims) noexcept {
  return static_cast<double>(VoxelBox{Vec3i(0), (dims + kBlockEdge - 1) / kBlockEdge}.count());
}

}  // namespace

std::uint64_t PagedBone::index_bytes(const Vec3i& dims, double share) noexcept {
  const Vec3i nodes = (dims + (kNodeEdge * kBlockEdge - 1)) / (kNodeEdge * kBlockEdge);
  const auto tables = static_cast<double>(VoxelBox{Vec3i(0), nodes}.count() * (sizeof(Node) + 2 * sizeof(void*)));
  constexpr double kPlaces = sizeof(std::uint32_t);  // a block whose place is free again
  return sizeof(PagedBone) + static_cast<std::uint64_t>(tables + share * blocks_in(dims) * (sizeof(Row) + kPlaces));
}

std::uint64_t PagedBone::file_bytes(const Vec3i& dims, bool soft, double share) noexcept {
  const double units = soft ? kMostUnits : kMostUnits - kFloatUnits;
  return static_cast<std::uint64_t>(share * blocks_in(dims) * units * kUnit);
}

}  // namespace burrhole
