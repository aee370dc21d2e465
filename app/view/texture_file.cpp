#include "app/view/texture_file.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "app/view/texture_pattern.h"
#include "core/base/input_file.h"

namespace burrhole {
namespace {

constexpr std::size_t kHeaderBytes = 24;  // signature, length and name of the first chunk, width, height
constexpr std::array<unsigned char, 8> kSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::array<unsigned char, 8> kFirstChunk{0, 0, 0, 13, 'I', 'H', 'D', 'R'};

std::uint32_t number_at(const std::array<char, kHeaderBytes>& bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t n = at; n < at + 4; ++n) out = out << 8 | static_cast<unsigned char>(bytes[n]);
  return out;
}

Status check_image(std::uint32_t width, std::uint32_t height) {
  if (width <= kLongestImage && height <= kLongestImage) return {};
  return bad_input(fmt::format("has {} x {} pixels, more than the {} of an edge that a texture may have: scale the image down", width,
                               height, kLongestImage));
}

Status check_volume(std::uint32_t width, std::uint32_t height) {
  if (height < 2 * static_cast<std::uint64_t>(width) || height % width != 0)
    return bad_input(
        fmt::format("has {} x {} pixels: a volume is a column of at least two square slices, so its height is a multiple of its width; "
                    "use a flat image as exterior_texture",
                    width, height));
  if (width <= kLongestVolume && height / width <= kLongestVolume) return {};
  return bad_input(fmt::format("has {0} slices of {1} x {1} pixels, more than the {2} of an edge that a volume may have: scale it down",
                               height / width, width, kLongestVolume));
}

std::uint64_t bytes_of(const Vec3i& dims) { return sizeof(Rgba8) * VoxelBox{Vec3i(0), dims}.count(); }

std::uint64_t bytes_of(const std::string& name, TextureKind kind) {
  if (name.empty()) return 0;
  if (is_pattern(name))
    return bytes_of(kind == TextureKind::exterior ? Vec3i(kPatternImageSide, kPatternImageSide, 1) : Vec3i(kPatternVolumeSide));
  const auto dims = read_texture_header(name, kind);
  return dims ? bytes_of(*dims) : 0;
}

}  // namespace

Result<Vec3i> read_texture_header(const std::string& path, TextureKind kind) {
  if (Status regular = check_regular_file(path); !regular) return regular.error();
  std::array<char, kHeaderBytes> bytes{};
  std::ifstream in(path, std::ios::binary);
  in.read(bytes.data(), kHeaderBytes);
  const bool whole = in.gcount() == static_cast<std::streamsize>(kHeaderBytes);
  if (!whole || std::memcmp(bytes.data(), kSignature.data(), 8) != 0 || std::memcmp(bytes.data() + 8, kFirstChunk.data(), 8) != 0)
    return bad_input("is not a PNG image: convert it to PNG", path);
  const std::uint32_t width = number_at(bytes, 16), height = number_at(bytes, 20);
  if (width == 0 || height == 0) return bad_input("has no pixels: give another image", path);
  const Status fits = kind == TextureKind::exterior ? check_image(width, height) : check_volume(width, height);
  if (!fits) return bad_input(fits.error().message, path);
  if (kind == TextureKind::exterior) return Vec3i(static_cast<int>(width), static_cast<int>(height), 1);
  return Vec3i(static_cast<int>(width), static_cast<int>(width), static_cast<int>(height / width));
}

std::uint64_t texture_bytes(const TextureConfig& config) {
  // Coarser levels add a third to an image and a seventh to a volume; the image is in memory once more until it is in the driver's.
  const std::uint64_t image = bytes_of(config.exterior, TextureKind::exterior), volume = bytes_of(config.interior, TextureKind::interior);
  return 2 * (image + volume) + image / 3 + volume / 7;
}

}  // namespace burrhole
