#include "core/voxel/surface_records.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/assert.h"
#include "core/voxel/box_parts.h"
#include "core/voxel/cut_surface.h"
#include "core/voxel/surface_memory.h"
#include "core/voxel/surface_tile.h"

// How a record is made (own derivation). Lengths are metric: M = linear / mean_edge takes index differences to voxel edges.
//   1. G, the gradient of the smoothed density (five taps an axis, surface_field.cpp). Plain differences alias on a ramp one voxel wide:
//      their direction is off by degrees. As a covector it reaches the bone's axes by M^-T; the outward normal there is n = -M^-T G,
//      normalised.
//   2. One surfel s a cell that the surface passes: the mean of the edges' crossings, moved along n to the trilinear 0.5 surface. All
//      detail of the surface itself is kept; only its direction comes from the smoothed field, or from the cell's own density where the two
//      are over 14 degrees apart: within two voxels of an edge smoothing mixes its faces, which put the edge up to 0.12 voxel off.
//   3. A voxel v takes its nearest surfel. The surfel's plane puts the foot of v at c = s + t, t the part of r = v - s across n_s. With
//      n_c from G at the foot, distance = (n_s + n_c) / 2 . r: on a sphere of radius R and centre o, s = o + R n_s and v = o + (R + h) n_v,
//      so (n_s + n_v) . (v - s) / 2 = ((R + h) - R) (1 + n_s . n_v) / 2, which is h to second order of the angle between the two, where a
//      plane alone is off by half its square times R. n_c = n_v to the same order. Over 20 degrees apart n_c is of another face, and within
//      the patch radius the plane alone counts; the record's normal stays n_c, a steady mean of the two faces: with the faces' own a flat
//      bit was tipped from one to the other and skated twice as far.
//   4. Further than the patch radius across, the surface ends (the outside of an edge, a tip): there the foot is held at the patch radius
//      and what is left counts as length: distance^2 = across^2 + rest^2, the normal the way from that foot.
// The side is the density's: at voxel centres the trilinear field is the density itself. Where that contradicts the plane the distance is
// 0.

namespace burrhole {
namespace {

/// Records made at once: bounds the scratch (about 40 bytes a voxel of the tile and its margins). By volume: the face under a wide bit is
/// flat, and margins cost less the fewer cuts there are.
constexpr std::size_t kMostInTile = 160'000;

/// How often a part is cut along each axis.
Vec3i tiles_of(const Vec3i& size) noexcept {
  Vec3i tiles(1);
  for (;;) {
    const Vec3i edges = (size + tiles - 1) / tiles;
    if (VoxelBox{Vec3i(0), edges}.count() <= kMostInTile) return tiles;
    const std::size_t axis = edges.x >= edges.y && edges.x >= edges.z ? 0 : edges.y >= edges.z ? 1 : 2;
    ++tiles[axis];
  }
}

static_assert(std::endian::native == std::endian::little, "records are put together as words");

/// What the tile found, over "at least that far" elsewhere.
template <class Record>
void store(const SurfaceTile& tile, const VoxelBox& box, std::vector<Record>& out) noexcept {
  const auto length = static_cast<std::size_t>(tile.records.size().x);
  for (int k = tile.records.lo.z; k < tile.records.hi.z; ++k)
    for (int j = tile.records.lo.y; j < tile.records.hi.y; ++j) {
      const Vec3i start(tile.records.lo.x, j, k);
      fill_far(tile.density.data() + tile.offset_of(start), length, out.data() + box.offset_of(start));
    }
  const Vec3i shift = tile.padded.lo - box.lo, size = box.size();
  for (std::size_t n = 0; n < tile.near; ++n) {
    const Vec3i v = unpack_position(tile.voxels[n]) + shift;
    Record& record = out[static_cast<std::size_t>((v.z * size.y + v.y) * size.x + v.x)];
    if constexpr (sizeof(Record) == sizeof(std::uint32_t))
      record = std::bit_cast<Record>(tile.low[n]);
    else
      record = std::bit_cast<Record>(tile.low[n] | (static_cast<std::uint64_t>(tile.high[n]) << 32));
  }
}

template <class Record>
SurfaceSample decoded(const Record& r, double distance_step, double normal_step) noexcept {
  return {distance_step * r.distance, normal_step * Vec3(r.nx, r.ny, r.nz)};
}

}  // namespace

SurfaceMap::SurfaceMap(const Affine& bone_from_index) {
  const Mat3 metric = bone_from_index.linear / bone_from_index.mean_edge();
  const Mat3 index = glm::inverse(metric);
  double longest = 0.0;
  for (std::size_t r = 0; r < 3; ++r) {
    double row2 = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      metric_from_index[r][c] = static_cast<float>(metric[c][r]);
      index_from_metric[r][c] = static_cast<float>(index[c][r]);
      row2 += index[c][r] * index[c][r];
    }
    // 15 is met by slices sixty times as thick as pixels only; there the band is a little short along the pixels.
    spread[r] = std::min(15, floor_int(kRecordBand * std::sqrt(row2)));
    longest = std::max(longest, glm::length(metric[r]));
  }
  patch_radius = static_cast<float>(longest);
  const int most = std::max({spread.x, spread.y, spread.z});
  code_bits = std::bit_width(static_cast<unsigned>(2 * most + 1));
}

void SurfaceTile::lay_out(const VoxelBox& to_make, const VoxelBox& window, const SurfaceMap& map) {
  records = to_make;
  const VoxelBox felt{to_make.lo - map.spread - 1, to_make.hi + map.spread};
  cells = felt.intersect({window.lo, window.hi - 1});
  padded = {felt.lo - 3, felt.hi + 4};
  const Vec3i size = padded.size();
  row = size.x;
  slab = size.x * size.y;
  const std::size_t count = padded.count() + 4 * kMaxLanes;
  // Nothing of an earlier tile is read, so its memory is released before a larger array is made, which then has no room that is not used.
  const auto make_room = []<class Field>(Field& field, std::size_t least) {
    if (field.size() >= least) return;
    Field().swap(field);
    field.resize(least);
  };
  make_room(density, count);
  make_room(samples, count);
  make_room(nearest, count);
  make_room(surfel_at, count);
  make_room(plane, 5 * (static_cast<std::size_t>(slab) + 4 * kMaxLanes));
  make_room(cell_offsets, cells.count() + 2 * kMaxLanes);
  make_room(voxels, records.count() + 2 * kMaxLanes);
  for (auto* list : {&low, &high}) make_room(*list, records.count() + 2 * kMaxLanes);
  words = (row + 63) / 64;
  const std::size_t slab_words = static_cast<std::size_t>(size.y * words);
  for (auto* bits : {&solid, &wanted}) make_room(*bits, slab_words * static_cast<std::size_t>(size.z));
  make_room(widened, 2 * slab_words);
}

std::uint64_t SurfaceTile::bytes() const noexcept {
  const auto of = [](const auto&... fields) { return ((fields.capacity() * sizeof(fields[0])) + ...); };
  return of(density, plane, samples, solid, wanted, widened, cell_offsets, surfels, surfel_at, nearest, voxels, low, high);
}

std::uint64_t record_scratch_bytes(std::uint64_t window_voxels, const Affine& bone_from_index) noexcept {
  constexpr std::uint64_t kPaddedVoxel = sizeof(float) + sizeof(FieldSample) + sizeof(std::uint32_t) + sizeof(std::int32_t);
  constexpr std::uint64_t kCell = sizeof(std::int32_t), kRecord = sizeof(std::int32_t) + 2 * sizeof(std::uint32_t);
  const double records = std::min(static_cast<double>(window_voxels), static_cast<double>(kMostInTile)), edge = std::cbrt(records);
  const SurfaceMap map(bone_from_index);
  double padded = 1.0, cells = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cells *= edge + 2.0 * map.spread[axis] + 1.0;
    padded *= edge + 2.0 * map.spread[axis] + 8.0;
  }
  return static_cast<std::uint64_t>(padded) * kPaddedVoxel + static_cast<std::uint64_t>(cells) * kCell +
         static_cast<std::uint64_t>(records) * kRecord;
}

struct SurfaceRecords::Work {
  SurfaceMap map;
  SurfaceTile tile;
};

SurfaceRecords::SurfaceRecords(const Affine& bone_from_index, RecordPrecision precision)
    : work_(std::make_unique<Work>(Work{SurfaceMap(bone_from_index), {}})) {
  if (precision == RecordPrecision::bits16) records_ = std::vector<Record16>();
}
SurfaceRecords::SurfaceRecords(SurfaceRecords&&) noexcept = default;
SurfaceRecords& SurfaceRecords::operator=(SurfaceRecords&&) noexcept = default;
SurfaceRecords::~SurfaceRecords() = default;

RecordPrecision SurfaceRecords::precision() const noexcept {
  return std::holds_alternative<std::vector<Record8>>(records_) ? RecordPrecision::bits8 : RecordPrecision::bits16;
}

Vec3i record_reach(const Affine& bone_from_index) noexcept { return SurfaceMap(bone_from_index).reach(); }

VoxelBox SurfaceRecords::valid_box() const noexcept {
  const Vec3i reach = work_->map.reach();
  return {box_.lo + reach, box_.hi - reach};
}

namespace {

/// Computes the records of `part` tile by tile and calls `use` after each.
template <class Use>
void make_tiles(const MasterWindow& window, const VoxelBox& part, const SurfaceMap& map, RecordPrecision precision, SurfaceTile& tile,
                const Use& use) {
  const Vec3i size = part.size();
  const Vec3i tiles = tiles_of(size);
  for_each_voxel({Vec3i(0), tiles}, [&](const Vec3i& t) {
    tile.lay_out({part.lo + size * t / tiles, part.lo + size * (t + 1) / tiles}, window.box, map);
    copy_density(window, tile);
    find_cells(tile);
    smooth_gradient(tile);
    make_surfels(map, tile);
    find_nearest(map, tile);
    make_records(map, precision, tile);
    use();
  });
}

}  // namespace

namespace {

Record16 converted(const Record16& record, Record16*) noexcept { return record; }

Record8 converted(const Record16& record, Record8*) noexcept {
  const auto narrow = [](std::int16_t value, double step) {
    return static_cast<std::int8_t>(std::lrint(static_cast<float>(value) * static_cast<float>(step)));
  };
  constexpr double kTurn = kRecord16Normal / kRecord8Normal;
  return {narrow(record.distance, kRecord16Distance / kRecord8Distance), narrow(record.nx, kTurn), narrow(record.ny, kTurn),
          narrow(record.nz, kTurn)};
}

/// Writes the records of a row of nodes that are set.
template <class Record>
void write_row(const CutSurface::Block& block, std::size_t from, std::size_t count, Record* to) noexcept {
  const auto convert = [](const Record16& record) { return converted(record, static_cast<Record*>(nullptr)); };
  if (block.complete) {
    std::transform(&block.record[from], &block.record[from] + count, to, convert);
    return;
  }
  for (std::size_t n = 0; n < count; ++n)
    if (block.base[from + n] != CutSurface::kUnset) to[n] = convert(block.record[from + n]);
}

}  // namespace

void SurfaceRecords::overlay(const CutSurface* cut, const VoxelBox& part) {
  if (cut == nullptr || cut->empty() || part.empty()) return;
  for_each_voxel(blocks_of(part), [&](const Vec3i& at) {
    const CutSurface::Block* const block = cut->find(at);
    if (block == nullptr) return;
    const VoxelBox here = box_of_block(at).intersect(part);
    const auto count = static_cast<std::size_t>(here.hi.x - here.lo.x);
    std::visit(
        [&](auto& records) {
          for (int k = here.lo.z; k < here.hi.z; ++k)
            for (int j = here.lo.y; j < here.hi.y; ++j) {
              const Vec3i first(here.lo.x, j, k);
              write_row(*block, CutSurface::Block::place(first), count, &records[box_.offset_of(first)]);
            }
        },
        records_);
  });
}

void SurfaceRecords::make(const MasterWindow& window, const VoxelBox& part) {
  SurfaceTile& tile = work_->tile;
  make_tiles(window, part, work_->map, precision(), tile,
             [&] { std::visit([&](auto& records) { store(tile, box_, records); }, records_); });
}

void SurfaceRecords::rebuild(const MasterWindow& window, const CutSurface* cut) {
  box_ = window.box;
  std::visit([&](auto& records) { records.resize(box_.count()); }, records_);
  make(window, box_);
  overlay(cut, box_);
}

VoxelBox SurfaceRecords::update(const MasterWindow& window, const VoxelBox& dirty) {
  BH_ASSERT(window.box == box_);
  const VoxelBox seen = dirty.intersect(box_);
  if (seen.empty()) return {};
  const Vec3i reach = work_->map.reach();
  const VoxelBox part = VoxelBox{seen.lo - reach, seen.hi + reach}.intersect(box_);
  make(window, part);
  return part;
}

std::vector<VoxelBox> SurfaceRecords::update_cut(const CutSurface& cut, std::span<const VoxelBox> dirty) {
  const Vec3i spread = work_->map.spread + 1;
  std::vector<VoxelBox> boxes;
  for (const VoxelBox& box : dirty) {
    boxes.push_back(VoxelBox{box.lo - spread, box.hi + spread}.intersect(box_));
    overlay(&cut, boxes.back());
  }
  return boxes;
}

std::vector<VoxelBox> SurfaceRecords::update(const MasterWindow& window, std::span<const VoxelBox> dirty) {
  // Each box is worked on with its reach: two whose reaches overlap cost more apart than as the box round both, once that wastes little.
  const Vec3i reach = work_->map.reach();
  const auto work = [&](const VoxelBox& box) { return VoxelBox{box.lo - reach, box.hi + reach}.intersect(box_).count(); };
  std::vector<VoxelBox> boxes(dirty.begin(), dirty.end());
  for (bool joined = true; joined;) {
    joined = false;
    for (std::size_t a = 0; a < boxes.size() && !joined; ++a)
      for (std::size_t b = a + 1; b < boxes.size() && !joined; ++b) {
        if (work(boxes[a].unite(boxes[b])) > work(boxes[a]) + work(boxes[b])) continue;
        boxes[a] = boxes[a].unite(boxes[b]);
        boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(b));
        joined = true;
      }
  }
  for (VoxelBox& box : boxes) box = update(window, box);
  return boxes;
}

void SurfaceRecords::slide(const MasterWindow& window, const CutSurface* cut) {
  // What is within reach of an edge of the old window saw another field there. What is within reach of an edge of the new one is not valid:
  // it is left, and computed when a later slide makes it valid.
  const VoxelBox from = box_, true_before = valid_box();
  box_ = window.box;
  const VoxelBox valid = valid_box(), kept = true_before.intersect(valid);
  std::visit([&](auto& records) { slide_array(from, box_, records); }, records_);
  if (valid.empty()) return;
  for (const VoxelBox& part : box_without(valid, kept.empty() ? VoxelBox{} : kept)) {
    make(window, part);
    overlay(cut, part);
  }
}

void SurfaceRecords::reserve(std::size_t window_voxels) {
  std::visit([&](auto& records) { records.reserve(window_voxels); }, records_);
}

std::size_t SurfaceRecords::bytes() const noexcept {
  return std::visit([](const auto& records) { return records.size() * sizeof(records[0]); }, records_);
}

struct SurfaceReader::Work {
  SurfaceMap map;
  SurfaceTile tile;
};

SurfaceReader::SurfaceReader(const Affine& bone_from_index) : work_(std::make_unique<Work>(Work{SurfaceMap(bone_from_index), {}})) {}
SurfaceReader::SurfaceReader(SurfaceReader&&) noexcept = default;
SurfaceReader& SurfaceReader::operator=(SurfaceReader&&) noexcept = default;
SurfaceReader::~SurfaceReader() = default;

void SurfaceReader::read(const MasterWindow& window, const VoxelBox& part, std::vector<Record16>& out) {
  out.resize(part.count());
  make_tiles(window, part, work_->map, RecordPrecision::bits16, work_->tile, [&] { store(work_->tile, part, out); });
}

SurfaceSample decode(const Record8& record) noexcept { return decoded(record, kRecord8Distance, kRecord8Normal); }
SurfaceSample decode(const Record16& record) noexcept { return decoded(record, kRecord16Distance, kRecord16Normal); }

}  // namespace burrhole
