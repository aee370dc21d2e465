#include "volumes/read/byte_stream.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

namespace burrhole {
namespace {

constexpr std::size_t kWindow = 262144;  ///< [bytes] of the file in memory
constexpr int kGzipOrZlib = 15 + 32;     ///< inflateInit2: largest window, detects the kind by the header

}  // namespace

Result<std::uint64_t> size_of_file(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return bad_input("there is no such file", path);
  if (!std::filesystem::is_regular_file(status)) return bad_input("is not a regular file", path);
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return bad_input("its size cannot be read", path);
  return static_cast<std::uint64_t>(size);
}

bool starts_as_gzip(const std::string& path) {
  const auto head = read_head(path, false, 2);
  return head && head.value().size() == 2 && head.value()[0] == std::byte{0x1f} && head.value()[1] == std::byte{0x8b};
}

struct ByteStream::State {
  std::string path;
  std::ifstream file;
  bool packed = false;
  bool ended = false;  ///< the packed data has ended
  bool cut = false;
  bool zlib_open = false;
  bool gzip = false;  ///< gzip may continue with another member, zlib may not
  bool started = false;
  z_stream zlib{};
  std::vector<unsigned char> window = std::vector<unsigned char>(kWindow);

  ~State() {
    if (zlib_open) inflateEnd(&zlib);
  }

  Result<std::size_t> from_file(unsigned char* to, std::size_t most) {
    file.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(most));
    if (file.bad()) return bad_input("cannot be read to its end", path);
    return static_cast<std::size_t>(file.gcount());
  }

  /// Reads more of the file behind the rest of the window. @returns whether there was more.
  Result<bool> refill() {
    const std::size_t left = zlib.avail_in;
    std::copy_n(zlib.next_in, left, window.data());
    const Result<std::size_t> got = from_file(window.data() + left, kWindow - left);
    if (!got) return got.error();
    zlib.next_in = window.data();
    zlib.avail_in = static_cast<uInt>(left + got.value());
    return got.value() > 0;
  }

  /// After the end of a member: starts the next one, if there is one. Anything else behind gzip data is padding.
  Status next_member() {
    if (gzip && zlib.avail_in < 2)
      if (const Result<bool> more = refill(); !more) return more.error();
    const bool another = gzip && zlib.avail_in >= 2 && zlib.next_in[0] == 0x1f && zlib.next_in[1] == 0x8b;
    if (!another)
      ended = true;
    else if (inflateReset(&zlib) != Z_OK)
      return bad_input("compressed data cannot be read further", path);
    return {};
  }

  Result<std::size_t> inflate_into(std::span<std::byte> out) {
    std::size_t filled = 0;
    while (filled < out.size() && !ended && !cut) {
      if (zlib.avail_in == 0) {
        const Result<bool> more = refill();
        if (!more) return more.error();
        if (!more.value()) {
          cut = true;
          break;
        }
      }
      if (!started) gzip = zlib.next_in[0] == 0x1f;
      started = true;
      const std::size_t room = std::min<std::size_t>(out.size() - filled, 1u << 30);
      zlib.next_out = reinterpret_cast<unsigned char*>(out.data() + filled);
      zlib.avail_out = static_cast<uInt>(room);
      const int answer = inflate(&zlib, Z_NO_FLUSH);
      filled += room - zlib.avail_out;
      if (answer == Z_STREAM_END) {
        if (const Status status = next_member(); !status) return status.error();
      } else if (answer != Z_OK && answer != Z_BUF_ERROR) {
        return bad_input("compressed data is damaged", path);
      }
    }
    return filled;
  }
};

ByteStream::ByteStream(std::unique_ptr<State> state) : state_(std::move(state)) {}
ByteStream::ByteStream(ByteStream&&) noexcept = default;
ByteStream& ByteStream::operator=(ByteStream&&) noexcept = default;
ByteStream::~ByteStream() = default;

Result<ByteStream> ByteStream::open(const std::string& path, std::uint64_t offset, bool packed) {
  const Result<std::uint64_t> size = size_of_file(path);
  if (!size) return size.error();
  auto state = std::make_unique<State>();
  state->path = path;
  state->packed = packed;
  state->file.open(path, std::ios::binary);
  if (!state->file) return bad_input("cannot be opened", path);
  state->file.seekg(static_cast<std::streamoff>(std::min(offset, size.value())));
  if (packed) {
    if (inflateInit2(&state->zlib, kGzipOrZlib) != Z_OK) return bad_input("compressed data cannot be read", path);
    state->zlib_open = true;
    state->zlib.next_in = state->window.data();
  }
  return ByteStream(std::move(state));
}

Result<std::size_t> ByteStream::read(std::span<std::byte> out) {
  if (state_->packed) return state_->inflate_into(out);
  return state_->from_file(reinterpret_cast<unsigned char*>(out.data()), out.size());
}

Result<std::uint64_t> ByteStream::skip(std::uint64_t count) {
  std::vector<std::byte> passed(kWindow);
  std::uint64_t done = 0;
  while (done < count) {
    const std::size_t want = static_cast<std::size_t>(std::min<std::uint64_t>(kWindow, count - done));
    const Result<std::size_t> got = read(std::span(passed).first(want));
    if (!got) return got.error();
    done += got.value();
    if (got.value() < want) break;
  }
  return done;
}

bool ByteStream::cut() const noexcept { return state_->cut; }

Result<std::vector<std::byte>> read_head(const std::string& path, bool packed, std::size_t most) {
  Result<ByteStream> stream = ByteStream::open(path, 0, packed);
  if (!stream) return stream.error();
  std::vector<std::byte> head(most);
  const Result<std::size_t> got = stream->read(head);
  if (!got) return got.error();
  head.resize(got.value());
  return head;
}

}  // namespace burrhole
