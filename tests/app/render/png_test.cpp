#include "app/render/png.h"
#include "tests/support/source_folder.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

using namespace burrhole;

namespace {

std::filesystem::path scratch(const char* name) {
  const std::filesystem::path folder = test::in_build("test-png");
  std::filesystem::create_directories(folder);
  return folder / name;
}

/// @returns how many files of the folder begin with the name of a picture.
int pictures_beside(const std::filesystem::path& picture) {
  int out = 0;
  for (const auto& entry : std::filesystem::directory_iterator(picture.parent_path()))
    out += entry.path().filename().string().starts_with(picture.filename().string()) ? 1 : 0;
  return out;
}

Image gradient() {
  Image image{5, 3, {}};
  for (int n = 0; n < 15; ++n) image.pixels.push_back({static_cast<std::uint8_t>(17 * n), 200, static_cast<std::uint8_t>(255 - n), 255});
  return image;
}

}  // namespace

TEST_CASE("png: what is written is what is read, and no part file stays") {
  const auto path = scratch("gradient.png");
  REQUIRE(write_png(path, gradient()).ok());
  const auto read = read_png(path);
  REQUIRE(read.ok());
  CHECK(read.value().width == 5);
  CHECK(read.value().height == 3);
  CHECK(read.value().pixels == gradient().pixels);
  CHECK(pictures_beside(path) == 1);
}

TEST_CASE("png: a place that cannot be written is named with the reason") {
  const Status written = write_png("/proc/none/picture.png", gradient());
  REQUIRE_FALSE(written.ok());
  CHECK(written.error().text().starts_with("/proc/none/picture.png: cannot be written: No such file"));
  const auto folder = scratch("a-folder.png");
  std::filesystem::create_directories(folder / "kept");
  CHECK_FALSE(write_png(folder, gradient()).ok());
  CHECK(pictures_beside(folder) == 1);
}

TEST_CASE("png: an empty picture and one whose size lies are refused") {
  CHECK_FALSE(write_png(scratch("empty.png"), {}).ok());
  Image wrong = gradient();
  wrong.width = 6;
  CHECK_FALSE(write_png(scratch("wrong.png"), wrong).ok());
}

TEST_CASE("png: a failed write leaves the old picture") {
  const auto path = scratch("old.png");
  REQUIRE(write_png(path, gradient()).ok());
  CHECK_FALSE(write_png(path, {}).ok());
  CHECK(read_png(path).ok());
}

TEST_CASE("png: what is no picture is refused") {
  CHECK_FALSE(read_png(scratch("missing.png")).ok());
  std::ofstream(scratch("text.png")) << "no picture";
  CHECK_FALSE(read_png(scratch("text.png")).ok());
}
