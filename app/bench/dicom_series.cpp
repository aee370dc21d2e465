#include "app/bench/dicom_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>

#include "app/report/file.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

/// Group, element and VR of an element, as bytes of an explicit little-endian file.
using Mark = std::array<char, 6>;
constexpr Mark kFileUid{0x02, 0x00, 0x03, 0x00, 'U', 'I'}, kUid{0x08, 0x00, 0x18, 0x00, 'U', 'I'},
    kPosition{0x20, 0x00, 0x32, 0x00, 'D', 'S'}, kIntercept{0x28, 0x00, 0x52, 0x10, 'D', 'S'}, kSlope{0x28, 0x00, 0x53, 0x10, 'D', 'S'};
constexpr std::size_t kPixels = 512 * 512, kBytesAPixel = 2;

struct Span {
  std::size_t at, length;
};

std::optional<Span> find_value(const std::string& bytes, const Mark& mark) {
  const std::size_t at = bytes.find(std::string_view(mark.data(), mark.size()));
  if (at == std::string::npos || at + 8 > bytes.size()) return std::nullopt;
  const auto low = static_cast<unsigned char>(bytes[at + 6]), high = static_cast<unsigned char>(bytes[at + 7]);
  return Span{at + 8, low + 256u * high};
}

/// Overwrites a value in place, padded with blanks. @returns false if the field is missing or shorter than the text.
bool put(std::string& bytes, const Mark& mark, std::string text) {
  const auto value = find_value(bytes, mark);
  if (!value || text.size() > value->length) return false;
  text.resize(value->length, ' ');
  bytes.replace(value->at, value->length, text);
  return true;
}

bool put_uid(std::string& bytes, const Mark& mark, int slice) {
  constexpr std::size_t kDigits = 5;
  const auto value = find_value(bytes, mark);
  if (!value || value->length < 2 * kDigits) return false;
  bytes.replace(value->at + value->length - kDigits, kDigits, fmt::format("{:05}", 10000 + slice));
  return true;
}

double number_of(const std::string& bytes, const Mark& mark, double otherwise) {
  const auto value = find_value(bytes, mark);
  return value ? std::strtod(bytes.substr(value->at, value->length).c_str(), nullptr) : otherwise;
}

}  // namespace

Result<std::vector<std::string>> write_long_series(const std::string& source_folder, const std::string& folder, int slices) {
  std::vector<std::string> sources;
  for (const auto& entry : fs::directory_iterator(source_folder)) sources.push_back(entry.path().string());
  std::sort(sources.begin(), sources.end());
  if (sources.empty()) return bad_input("holds no files", source_folder);
  std::vector<std::string> out;
  for (int slice = 0; slice < slices; ++slice) {
    auto bytes = read_file(sources[static_cast<std::size_t>(slice) % sources.size()]);
    if (!bytes) return bytes.error();
    const bool changed =
        put_uid(*bytes, kFileUid, slice) && put_uid(*bytes, kUid, slice) && put(*bytes, kPosition, fmt::format("-115.5\\-1.85\\{}", slice));
    if (!changed) return bad_input("lacks a field of an image slice", sources[static_cast<std::size_t>(slice) % sources.size()]);
    out.push_back((fs::path(folder) / fmt::format("slice{:04}.dcm", slice)).string());
    if (const Status written = write_file(out.back(), *bytes); !written) return written.error();
  }
  return out;
}

Result<std::vector<float>> read_plainly(const std::vector<std::string>& files) {
  std::vector<float> out;
  out.reserve(files.size() * kPixels);
  for (const std::string& file : files) {
    const auto bytes = read_file(file);
    if (!bytes) return bytes.error();
    if (bytes->size() < kPixels * kBytesAPixel) return bad_input("is too short", file);
    const double slope = number_of(*bytes, kSlope, 1.0), intercept = number_of(*bytes, kIntercept, 0.0);
    const char* pixel = bytes->data() + bytes->size() - kPixels * kBytesAPixel;
    for (std::size_t n = 0; n < kPixels; ++n, pixel += kBytesAPixel) {
      std::int16_t stored = 0;
      std::memcpy(&stored, pixel, kBytesAPixel);
      out.push_back(static_cast<float>(slope * stored + intercept));
    }
  }
  return out;
}

}  // namespace burrhole
