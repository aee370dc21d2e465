#include "volumes/read/dicom_bytes.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/base/input_file.h"

namespace burrhole {
namespace {

constexpr std::size_t kWindow = 16 * 1024;                   // [bytes] holds most headers
constexpr std::size_t kMostInflated = std::size_t{1} << 28;  // [bytes]

}  // namespace

Result<DicomBytes> DicomBytes::open(const std::string& path) {
  if (Status regular = check_regular_file(path); !regular) return regular.error();
  DicomBytes out;
  out.file_.rdbuf()->pubsetbuf(nullptr, 0);  // window_ is the buffer
  out.file_.open(path, std::ios::binary | std::ios::ate);
  if (!out.file_) return bad_input("the file cannot be opened for reading", path);
  const auto end = out.file_.tellg();
  if (end < 0) return bad_input("the file has no size that could be read", path);
  out.size_ = static_cast<std::uint64_t>(end);
  return Result<DicomBytes>(std::move(out));
}

bool DicomBytes::read(std::uint64_t offset, std::span<std::byte> out) {
  if (offset > size_ || out.size() > size_ - offset) return false;
  if (out.empty()) return true;
  if (in_memory_) {
    std::memcpy(out.data(), inflated_.data() + offset, out.size());
    return true;
  }
  const bool inside = offset >= window_offset_ && offset - window_offset_ + out.size() <= window_.size();
  if (!inside) {
    const bool small = out.size() <= kWindow;
    if (small) window_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kWindow, size_ - offset)));
    const std::span<std::byte> target = small ? std::span<std::byte>(window_) : out;
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(offset));
    file_.read(reinterpret_cast<char*>(target.data()), static_cast<std::streamsize>(target.size()));
    if (!file_) {
      window_.clear();
      return false;
    }
    if (!small) return true;
    window_offset_ = offset;
  }
  std::memcpy(out.data(), window_.data() + (offset - window_offset_), out.size());
  return true;
}

std::string DicomBytes::inflate_from(std::uint64_t offset) {
  std::vector<std::byte> packed(static_cast<std::size_t>(size_ - std::min(offset, size_)));
  if (!read(offset, packed)) return "the deflated data set cannot be read";
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return "the deflated data set cannot be inflated";
  std::size_t fed = 0, made = 0;
  int state = Z_OK;
  while (state == Z_OK && made < kMostInflated) {
    if (made == inflated_.size()) inflated_.resize(std::min(kMostInflated, std::max<std::size_t>(2 * made, 4 * packed.size() + kWindow)));
    const std::size_t in = std::min<std::size_t>(packed.size() - fed, std::size_t{1} << 30);
    const std::size_t room = inflated_.size() - made;
    stream.next_in = reinterpret_cast<Bytef*>(packed.data() + fed);
    stream.avail_in = static_cast<uInt>(in);
    stream.next_out = reinterpret_cast<Bytef*>(inflated_.data() + made);
    stream.avail_out = static_cast<uInt>(room);
    state = ::inflate(&stream, Z_NO_FLUSH);
    fed += in - stream.avail_in;
    made += room - stream.avail_out;
  }
  inflateEnd(&stream);
  inflated_.resize(made);
  size_ = made;
  in_memory_ = true;
  if (state == Z_STREAM_END) return {};
  if (state == Z_OK) return fmt::format("the deflated data set is larger than {} bytes", kMostInflated);
  return fmt::format("the deflated data set is {} after {} bytes", state == Z_BUF_ERROR ? "cut short" : "damaged", made);
}

}  // namespace burrhole
