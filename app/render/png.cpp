#include "app/render/png.h"

#include <png.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

namespace burrhole {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

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

Status write_to(const std::filesystem::path& path, const Image& image) {
  File file(std::fopen(path.c_str(), "wb"));
  if (!file) return bad_input(std::string("cannot write the picture: ") + std::strerror(errno), path.string());
  png_image header = make_header(image.width, image.height);
  const bool encoded = png_image_write_to_stdio(&header, file.get(), 0, image.pixels.data(), 0, nullptr) != 0;
  const bool flushed = std::fflush(file.get()) == 0 && fsync(fileno(file.get())) == 0;
  if (encoded && flushed) return {};
  return bad_input(std::string("cannot write the picture: ") + (encoded ? std::strerror(errno) : header.message), path.string());
}

}  // namespace

Status write_png(const std::filesystem::path& path, const Image& image) {
  if (!holds_picture(image)) return bad_input("an empty picture is not written", path.string());
  std::filesystem::path temporary = path;
  temporary += ".part";
  Status written = write_to(temporary, image);
  std::error_code failed;
  if (written) std::filesystem::rename(temporary, path, failed);
  if (failed) written = bad_input("cannot write the picture: " + failed.message(), path.string());
  if (!written) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    return bad_input(written.error().message, path.string());
  }
  return {};
}

Result<Image> read_png(const std::filesystem::path& path) {
  png_image header = make_header(0, 0);
  if (png_image_begin_read_from_file(&header, path.c_str()) == 0) return bad_input(header.message, path.string());
  header.format = PNG_FORMAT_RGBA;
  Image image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.pixels.resize(static_cast<std::size_t>(header.width) * header.height);
  if (png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr) == 0) return bad_input(header.message, path.string());
  return image;
}

}  // namespace burrhole
