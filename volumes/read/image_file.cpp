#include "volumes/read/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <new>
#include <span>

#include "volumes/read/byte_stream.h"
#include "volumes/read/memory_check.h"
#include "volumes/read/number_text.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {
namespace {

constexpr std::size_t kPiece = 32768;           ///< [voxels] converted per step
constexpr std::uint64_t kMostInflation = 1032;  ///< largest ratio of deflate: zlib's technical notes, "maximum compression factor"
constexpr std::uint64_t kShortestNumber = 2;    ///< [bytes] a digit and a blank

struct Share {
  std::uint64_t voxels = 0, bytes = 0;  ///< bytes after decompression
};

Error ends_early(std::uint64_t has, const Share& share, const VoxelPart& part) {
  return bad_input(fmt::format("data ends after {} of {} bytes", has, share.bytes), part.path);
}

/// Decompresses and discards. @returns whether there is more data than the share.
Result<bool> check_packed(const VoxelPart& part, const Share& share, std::uint64_t packed_bytes) {
  if (packed_bytes < (part.inner_offset + share.bytes) / kMostInflation)
    return bad_input(fmt::format("{} compressed bytes cannot hold {} bytes of data", packed_bytes, share.bytes), part.path);
  Result<ByteStream> stream = ByteStream::open(part.path, part.offset, true);
  if (!stream) return stream.error();
  const Result<std::uint64_t> before = stream->skip(part.inner_offset);
  if (!before) return before.error();
  const Result<std::uint64_t> has = stream->skip(share.bytes);
  if (!has) return has.error();
  if (has.value() < share.bytes) return ends_early(has.value(), share, part);
  const Result<std::uint64_t> more = stream->skip(1);  // also reads the checksum
  if (!more) return more.error();
  if (stream->cut()) return bad_input(fmt::format("compressed data is cut short behind its {} bytes", share.bytes), part.path);
  return more.value() > 0;
}

/// Checks that the part contains its share; sets the offset of a part at the end. @returns whether there is more data than the share.
Result<bool> check_part(VoxelPart& part, const Share& share, Packing packing) {
  const Result<std::uint64_t> size = size_of_file(part.path);
  if (!size) return size.error();
  if (part.at_end) part.offset = size.value() > share.bytes ? size.value() - share.bytes : 0;
  const std::uint64_t has = size.value() > part.offset ? size.value() - part.offset : 0;
  switch (packing) {
    case Packing::raw:
      if (has < share.bytes) return ends_early(has, share, part);
      return has > share.bytes;
    case Packing::text:
      if (has < share.voxels * kShortestNumber - 1)
        return bad_input(fmt::format("{} bytes of text cannot hold {} numbers", has, share.voxels), part.path);
      return false;
    case Packing::packed:
      break;
  }
  return check_packed(part, share, has);
}

/// Reads and converts, piece by piece. `done` counts the voxels of all parts, for progress.
Status fill_binary(const VoxelPart& part, const ImageFile& file, std::span<float> out, const std::function<Status(std::size_t)>& done) {
  Result<ByteStream> stream = ByteStream::open(part.path, part.offset, file.packing == Packing::packed);
  if (!stream) return stream.error();
  if (const Result<std::uint64_t> before = stream->skip(part.inner_offset); !before) return before.error();
  const std::size_t width = bytes_of(file.head.form.type);
  std::vector<std::byte> piece(kPiece * width);
  for (std::size_t at = 0; at < out.size(); at += kPiece) {
    const std::span<float> to = out.subspan(at, std::min(kPiece, out.size() - at));
    const std::span<std::byte> raw = std::span(piece).first(to.size() * width);
    const Result<std::size_t> got = stream->read(raw);
    if (!got) return got.error();
    if (got.value() < raw.size()) return bad_input("changed while it was read", part.path);
    to_float(raw, file.head.form, to);
    if (Status on = done(to.size()); !on) return on;
  }
  return {};
}

Status fill_text(const VoxelPart& part, const ImageFile& file, std::span<float> out, const std::function<Status(std::size_t)>& done) {
  Result<ByteStream> stream = ByteStream::open(part.path, part.offset, false);
  if (!stream) return stream.error();
  std::vector<std::byte> piece(kPiece);
  std::string word;
  std::size_t at = 0;
  const auto take = [&]() -> Status {
    if (word.empty() || at == out.size()) return {};
    const auto value = number_of(word);
    if (!value) return bad_input(fmt::format("value {} of the data is not a number", at + 1), part.path);
    out[at++] = static_cast<float>(file.head.form.slope * *value + file.head.form.intercept);
    word.clear();
    return {};
  };
  for (std::size_t got = kPiece; got == kPiece && at < out.size();) {
    const Result<std::size_t> read = stream->read(piece);
    if (!read) return read.error();
    got = read.value();
    for (std::size_t n = 0; n < got; ++n) {
      const char c = static_cast<char>(piece[n]);
      if (is_blank(c) || c == ',') {
        if (Status status = take(); !status) return status;
      } else if (word.push_back(c); word.size() > kLongestNumber) {
        return bad_input(fmt::format("value {} of the data is not a number", at + 1), part.path);
      }
    }
  }
  if (Status status = take(); !status) return status;
  if (at < out.size()) return bad_input(fmt::format("data ends after {} of {} numbers", at, out.size()), part.path);
  return done(out.size());
}

/// @returns whether a part has data after the voxels.
Result<bool> check_parts(ImageFile& file, const Share& share) {
  bool surplus = false;
  for (VoxelPart& part : file.parts) {
    const Result<bool> more = check_part(part, share, file.packing);
    if (!more) return more.error();
    if (more.value() && file.exact)
      return bad_input(fmt::format("holds {} bytes, {} more than the volume needs", size_of_file(part.path).value(),
                                   size_of_file(part.path).value() - part.offset - share.bytes),
                       part.path);
    surplus = surplus || more.value();
  }
  return surplus;
}

Status fill(const ImageFile& file, std::vector<float>& values, const ReadOptions& options) {
  const std::size_t share = values.size() / file.parts.size();
  std::size_t finished = 0;
  const auto done = [&](std::size_t voxels) {
    finished += voxels;
    return advance(options, static_cast<double>(finished) / static_cast<double>(values.size()));
  };
  for (std::size_t n = 0; n < file.parts.size(); ++n) {
    const std::span<float> out = std::span(values).subspan(n * share, share);
    Status status = file.packing == Packing::text ? fill_text(file.parts[n], file, out, done) : fill_binary(file.parts[n], file, out, done);
    if (!status) return status;
  }
  return {};
}

/// Other programs keep the mark of an exported file when they replace its values.
void settle_density(std::span<const float> values, ImageFile& file) {
  if (std::ranges::all_of(values, [](float v) { return v >= 0.0f && v <= 1.0f; })) {
    file.quantity = Quantity::occupancy;
    file.head.assumed.emplace_back("the values are density that burrhole has exported: they are taken for occupancy");
  } else {
    file.head.assumed.emplace_back(
        "the header says density that burrhole has exported, and the values are none: they are taken for those of a scan");
  }
}

}  // namespace

Result<ReadScan> read_image(ImageFile file, const ReadOptions& options) {
  const Vec3i dims = file.head.dims;
  if (file.head.own_density && options.by_values) {
    file.head.own_density = false;
    file.head.assumed.emplace_back(
        "the header says density that burrhole has exported; with a band of bone, the values are taken for those of a scan");
  }
  if (const auto error = dims_error(dims.x, dims.y, dims.z)) return bad_input(*error, file.place);
  if (const auto error = affine_error(file.head.bone_from_index)) return bad_input(*error, file.place);
  if (file.parts.empty() || static_cast<std::size_t>(dims.z) % file.parts.size() != 0)
    return bad_input(fmt::format("{} data files do not share {} slices evenly", file.parts.size(), dims.z), file.place);
  if (options.accept)
    if (Status accepted = options.accept({.dims = dims,
                                          .bone_from_index = file.head.bone_from_index,
                                          .quantity = file.head.own_density ? Quantity::occupancy : file.quantity,
                                          .values = {}});
        !accepted)
      return accepted.error();
  const std::size_t voxels = VoxelBox{Vec3i(0), dims}.count();
  const std::uint64_t share = voxels / file.parts.size();
  const Result<bool> surplus = check_parts(file, {.voxels = share, .bytes = share * bytes_of(file.head.form.type)});
  if (!surplus) return surplus.error();
  // A valid file of a few MB may decompress to a thousand times its size.
  if (const auto error = memory_error(static_cast<double>(voxels) * sizeof(float), options.memory))
    return Error{ErrorCode::unavailable, fmt::format("{} x {} x {} voxels: {}", dims.x, dims.y, dims.z, *error), file.place};
  ReadScan out;
  try {
    out.scan.values.resize(voxels);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::unavailable, fmt::format("{} voxels do not fit into memory", voxels), file.place};
  }
  if (const Status status = fill(file, out.scan.values, options); !status) return status.error();
  if (file.head.own_density) settle_density(out.scan.values, file);
  out.scan.dims = dims;
  out.scan.bone_from_index = file.head.bone_from_index;
  out.scan.quantity = file.quantity;
  out.report.format = file.format;
  out.report.assumed = std::move(file.head.assumed);
  if (surplus.value()) out.report.assumed.emplace_back("data continues after the last voxel: the rest is ignored");
  return out;
}

}  // namespace burrhole
