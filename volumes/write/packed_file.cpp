#include "volumes/write/packed_file.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace burrhole {
namespace {

constexpr int kGzip = 15 + 16;          ///< deflateInit2: largest window, gzip header
constexpr int kMemoryLevel = 8;         ///< zlib's default
constexpr std::size_t kPiece = 65536;   ///< [bytes] of packed data at a time
constexpr std::size_t kMost = 1 << 30;  ///< [bytes] given to zlib at a time, whose counts have 32 bits

}  // namespace

struct PackedFile::State {
  State(OutputFile out, std::string name) : file(std::move(out)), path(std::move(name)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (packed) deflateEnd(&zlib);
  }
  /// Packs what zlib has been given. @param flush Z_NO_FLUSH, or Z_FINISH for the end of the member.
  [[nodiscard]] Status deflate_all(int flush) {
    std::array<unsigned char, kPiece> piece;
    do {
      zlib.next_out = piece.data();
      zlib.avail_out = kPiece;
      if (deflate(&zlib, flush) == Z_STREAM_ERROR) return write_error(path, EIO);
      if (Status written = file.write(std::as_bytes(std::span(piece)).first(kPiece - zlib.avail_out)); !written) return written;
    } while (zlib.avail_out == 0);
    return {};
  }

  OutputFile file;
  std::string path;
  bool packed = false;
  z_stream zlib{};
};

PackedFile::PackedFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
PackedFile::PackedFile(PackedFile&&) noexcept = default;
PackedFile::~PackedFile() = default;

Result<PackedFile> PackedFile::create(const std::string& path, const std::atomic<bool>* stop) {
  auto file = OutputFile::create(path, stop);
  if (!file) return file.error();
  return PackedFile(std::make_unique<State>(std::move(file).value(), path));
}

Status PackedFile::pack() {
  State& s = *state_;
  s.packed = deflateInit2(&s.zlib, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, kMemoryLevel, Z_DEFAULT_STRATEGY) == Z_OK;
  return s.packed ? Status() : Status(write_error(s.path, ENOMEM));
}

Status PackedFile::write(std::span<const std::byte> bytes) {
  State& s = *state_;
  if (!s.packed) return s.file.write(bytes);
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(bytes.size(), kMost));
    // zlib does not write through this pointer; its type is older than const.
    s.zlib.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(part.data()));  // NOLINT(cppcoreguidelines-pro-type-const-cast)
    s.zlib.avail_in = static_cast<uInt>(part.size());
    if (Status written = s.deflate_all(Z_NO_FLUSH); !written) return written;
    bytes = bytes.subspan(part.size());
  }
  return {};
}

Result<std::uint64_t> PackedFile::commit() {
  State& s = *state_;
  if (s.packed) {
    s.zlib.avail_in = 0;
    if (const Status written = s.deflate_all(Z_FINISH); !written) return written.error();
  }
  return s.file.commit();
}

}  // namespace burrhole
