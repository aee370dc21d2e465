#include "app/render/png.h"

#include <png.h>
#include <cstring>
#include <vector>

#include "core/base/output_file.h"

namespace burrhole {
namespace {

constexpr png_uint_32 kLongestPicture = 16384;  // [pixels] as the renderer draws

png_image make_header(int width, int height) {
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(width);
  header.height = static_cast<png_uint_32>(height);
  header.format = PNG_FORMAT_RGBA;
  header.flags = PNG_IMAGE_FLAG_FAST;
  return header;
}

bool holds_picture(const Image& image) {
  return image.width > 0 && image.height > 0 &&
         image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

}  // namespace

Status write_png(const std::filesystem::path& path, const Image& image) {
  if (!holds_picture(image)) return bad_input("an empty picture is not written", path.string());
  auto file = OutputFile::create(path.string());
  if (!file) return file.error();
  png_image header = make_header(image.width, image.height);
  std::vector<std::byte> bytes(PNG_IMAGE_PNG_SIZE_MAX(header));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) == 0)
    return bad_input(std::string("the picture cannot be encoded: ") + header.message, path.string());
  if (Status written = file->write(std::span(bytes).first(size)); !written) return written;
  const auto done = file->commit();
  return done ? Status() : Status(done.error());
}

Result<Image> read_png(const std::filesystem::path& path) {
  png_image header = make_header(0, 0);
  if (png_image_begin_read_from_file(&header, path.c_str()) == 0) return bad_input(header.message, path.string());
  if (header.width > kLongestPicture || header.height > kLongestPicture) {
    const std::string size = std::to_string(header.width) + " x " + std::to_string(header.height);
    png_image_free(&header);
    return bad_input("has " + size + " pixels, more than the " + std::to_string(kLongestPicture) + " of an edge that a picture may have",
                     path.string());
  }
  header.format = PNG_FORMAT_RGBA;
  Image image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.pixels.resize(static_cast<std::size_t>(header.width) * header.height);
  if (png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr) == 0) return bad_input(header.message, path.string());
  return image;
}

}  // namespace burrhole
