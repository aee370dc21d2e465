#include "core/voxel/vdb_header.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <string>
#include <utility>

namespace burrhole {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

constexpr std::int64_t kMagic = 0x56444220;        // " BDV"
constexpr std::uint32_t kFlagOfCompression = 222;  // versions below it have one byte of the file for it, later ones four of each grid
constexpr std::uint64_t kUuid = 36;                // characters
constexpr std::uint64_t kLongestName = 4096;       // of a grid, a type or a key of metadata
constexpr std::uint64_t kMostMetadata = 4096;      // entries of one map
constexpr std::int32_t kMostGrids = 1024;
constexpr const char* kCut = "ends within its header";

/// Reads numbers and texts, and keeps the first error.
class Header {
 public:
  Header(std::istream& in, std::uint64_t size) : in_(in), size_(size) {}

  [[nodiscard]] bool good() const noexcept { return !fault_; }
  [[nodiscard]] const std::optional<std::string>& fault() const noexcept { return fault_; }
  bool fail(std::string what) {
    if (!fault_) fault_ = std::move(what);
    return false;
  }
  [[nodiscard]] std::uint64_t position() const noexcept { return at_; }

  template <class Number>
  Number number() {
    std::array<char, sizeof(Number)> bytes{};
    if (take(bytes.data(), bytes.size())) return std::bit_cast<Number>(bytes);
    return Number{};
  }
  bool skip(std::uint64_t bytes) { return go_to(bytes <= size_ - at_ ? at_ + bytes : size_ + 1); }
  bool go_to(std::uint64_t position) {
    if (!good()) return false;
    if (position > size_ || !in_.seekg(static_cast<std::streamoff>(position))) return fail(kCut);
    at_ = position;
    return true;
  }
  /// A length and as many bytes. @param what names them in an error.
  std::string text(const char* what) {
    const auto length = number<std::uint32_t>();
    if (good() && length > size_ - at_) fail(fmt::format("names a length of {} bytes for {}, which is beyond its end", length, what));
    if (good() && length > kLongestName) fail(fmt::format("has {} of {} bytes, at most {} are read", what, length, kLongestName));
    std::string out(good() ? length : 0, '\0');
    take(out.data(), out.size());
    return out;
  }

 private:
  bool take(char* to, std::size_t bytes) {
    if (!good()) return false;
    if (bytes > size_ - at_ || !in_.read(to, static_cast<std::streamsize>(bytes))) return fail(kCut);
    at_ += bytes;
    return true;
  }

  std::istream& in_;
  std::uint64_t size_, at_ = 0;
  std::optional<std::string> fault_;
};

/// Names, types and sizes of metadata; the values are skipped.
bool check_metadata(Header& header) {
  const auto count = header.number<std::uint32_t>();
  if (header.good() && count > kMostMetadata)
    return header.fail(fmt::format("has {} entries of metadata, at most {} are read", count, kMostMetadata));
  for (std::uint32_t n = 0; n < count && header.good(); ++n) {
    header.text("a name of metadata");
    header.text("a type of metadata");
    header.skip(header.number<std::uint32_t>());
  }
  return header.good();
}

/// The descriptor of a grid: its names and where it lies. @returns its end in the file, as the descriptor says.
std::uint64_t check_descriptor(Header& header) {
  header.text("the name of a grid");
  header.text("the type of a grid");
  header.text("the name of an instance's parent");
  header.skip(2 * sizeof(std::int64_t));  // places of the grid and of its voxels
  return header.number<std::uint64_t>();
}

void check_grids(Header& header, std::uint32_t version, bool has_offsets) {
  const auto count = header.number<std::int32_t>();
  if (header.good() && (count < 0 || count > kMostGrids))
    header.fail(fmt::format("names {} grids, from 0 to {} are read", count, kMostGrids));
  for (std::int32_t n = 0; n < count && header.good(); ++n) {
    const std::uint64_t end = check_descriptor(header);
    if (version >= kFlagOfCompression) header.skip(sizeof(std::uint32_t));
    check_metadata(header);
    header.text("the kind of a transform");
    if (n + 1 == count || !has_offsets) return;
    if (header.good() && end < header.position()) header.fail("has a grid that ends before it starts");
    header.go_to(end);
  }
}

}  // namespace

std::optional<std::string> vdb_header_fault(std::istream& in, std::uint64_t size) {
  Header header(in, size);
  const auto magic = header.number<std::int64_t>();
  const auto version = header.number<std::uint32_t>();
  if (!header.good() || magic != kMagic) return "is no .vdb file";
  if (version < kOldestVdbVersion || version > kNewestVdbVersion)
    return fmt::format("has version {} of the format; {} to {} are read", version, kOldestVdbVersion, kNewestVdbVersion);
  header.skip(2 * sizeof(std::uint32_t));  // version of the library
  const bool has_offsets = header.number<char>() != 0;
  if (version < kFlagOfCompression) header.skip(1);
  header.skip(kUuid);
  check_metadata(header);
  check_grids(header, version, has_offsets);
  return header.fault();
}

}  // namespace burrhole
