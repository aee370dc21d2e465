#include "volumes/write/output_file.h"

#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace burrhole {
namespace {

constexpr int kGzip = 15 + 16;          ///< deflateInit2: largest window, gzip header
constexpr int kMemoryLevel = 8;         ///< zlib's default
constexpr std::size_t kPiece = 65536;   ///< [bytes] of packed data at a time
constexpr std::size_t kMost = 1 << 30;  ///< [bytes] given to zlib at a time, whose counts have 32 bits

}  // namespace

struct OutputFile::State {
  std::string path, temporary;
  const std::atomic<bool>* stop = nullptr;
  std::FILE* file = nullptr;
  bool packed = false;
  z_stream zlib{};
  std::uint64_t bytes = 0;
  Status status;

  ~State() {
    if (packed) deflateEnd(&zlib);
    if (file == nullptr) return;
    std::fclose(file);
    std::remove(temporary.c_str());
  }
  [[nodiscard]] Status fail(int code) {
    if (status) status = bad_input(std::string("cannot be written: ") + std::strerror(code), path);
    return status;
  }
  [[nodiscard]] Status check_stop() {
    if (status && stop != nullptr && stop->load(std::memory_order_relaxed))
      status = Error{ErrorCode::unavailable, "the writing was stopped: the file is as it was before", path};
    return status;
  }
  [[nodiscard]] Status put(const void* from, std::size_t count) {
    if (std::fwrite(from, 1, count, file) != count) return fail(errno);
    bytes += count;
    return status;
  }
  /// Packs what zlib has been given. @param flush Z_NO_FLUSH, or Z_FINISH for the end of the member.
  [[nodiscard]] Status deflate_all(int flush) {
    std::array<unsigned char, kPiece> piece;
    do {
      zlib.next_out = piece.data();
      zlib.avail_out = kPiece;
      if (deflate(&zlib, flush) == Z_STREAM_ERROR) return fail(EIO);
      if (Status written = put(piece.data(), kPiece - zlib.avail_out); !written) return written;
    } while (zlib.avail_out == 0);
    return status;
  }
};

OutputFile::OutputFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile::~OutputFile() = default;

Result<OutputFile> OutputFile::create(const std::string& path, const std::atomic<bool>* stop) {
  auto state = std::make_unique<State>();
  state->path = path;
  state->stop = stop;
  state->temporary = path + "." + std::to_string(::getpid()) + ".tmp";
  state->file = std::fopen(state->temporary.c_str(), "wb");
  if (state->file == nullptr) return state->fail(errno).error();
  return OutputFile(std::move(state));
}

void OutputFile::pack() {
  state_->packed = deflateInit2(&state_->zlib, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, kMemoryLevel, Z_DEFAULT_STRATEGY) == Z_OK;
  if (!state_->packed) (void)state_->fail(ENOMEM);
}

Status OutputFile::write(std::span<const std::byte> bytes) {
  if (!state_->check_stop()) return state_->status;
  if (!state_->packed) return state_->put(bytes.data(), bytes.size());
  while (!bytes.empty() && state_->status) {
    const auto part = bytes.first(std::min(bytes.size(), kMost));
    // zlib does not write through this pointer; its type is older than const.
    state_->zlib.next_in =
        const_cast<Bytef*>(reinterpret_cast<const Bytef*>(part.data()));  // NOLINT(cppcoreguidelines-pro-type-const-cast)
    state_->zlib.avail_in = static_cast<uInt>(part.size());
    (void)state_->deflate_all(Z_NO_FLUSH);
    bytes = bytes.subspan(part.size());
  }
  return state_->status;
}

Result<std::uint64_t> OutputFile::finish() {
  State& s = *state_;
  if (s.check_stop() && s.packed) {
    s.zlib.avail_in = 0;
    (void)s.deflate_all(Z_FINISH);
  }
  if (!s.status) return s.status.error();
  if (std::fflush(s.file) != 0) return s.fail(errno).error();
  std::FILE* const file = std::exchange(s.file, nullptr);
  const bool renamed = std::fclose(file) == 0 && std::rename(s.temporary.c_str(), s.path.c_str()) == 0;
  const int code = errno;
  if (renamed) return s.bytes;
  std::remove(s.temporary.c_str());
  return s.fail(code).error();
}

}  // namespace burrhole
