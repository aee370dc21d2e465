// The textures that a scene names: patterns and files, whole or damaged.
#include "app/render/texture_load.h"

#include <doctest/doctest.h>

#include <filesystem>

#include "app/render/png.h"
#include "app/view/texture_pattern.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;

namespace {

/// Noise, so that a cut file lacks pixels.
Image noise(int width, int height) {
  Image out{width, height, {}};
  std::uint32_t state = 7;
  for (int n = 0; n < width * height; ++n) {
    state = state * 1664525u + 1013904223u;
    out.pixels.push_back(
        {static_cast<std::uint8_t>(state >> 8), static_cast<std::uint8_t>(state >> 16), static_cast<std::uint8_t>(state >> 24), 255});
  }
  return out;
}

}  // namespace

TEST_CASE("textures: files and patterns are what they are named, with their scale, and none is nothing") {
  const TemporaryFolder folder;
  REQUIRE(load_textures({}).ok());
  CHECK(*load_textures({}) == nullptr);
  const Image flat = noise(30, 20), column = noise(8, 24);
  REQUIRE((write_png(folder.file("flat.png"), flat).ok() && write_png(folder.file("column.png"), column).ok()));
  TextureConfig config;
  config.exterior = folder.file("flat.png"), config.interior = folder.file("column.png"), config.axis = 1;
  const auto files = load_textures(config);
  REQUIRE(files.ok());
  CHECK((*files)->exterior.pixels == flat.pixels);
  CHECK((*files)->interior.dims == Vec3i(8, 8, 3));
  CHECK((*files)->interior.pixels == column.pixels);
  CHECK(!(*files)->exterior_tiles);
  CHECK(!(*files)->interior_tiles);
  CHECK((*files)->axis == 1);
  config.exterior.clear(), config.interior = "bone", config.interior_edge = 0.01;
  const auto pattern = load_textures(config);
  REQUIRE(pattern.ok());
  CHECK((*pattern)->exterior.pixels.empty());
  CHECK((*pattern)->interior.pixels == make_interior_pattern("bone").pixels);
  CHECK((*pattern)->interior_tiles);
  CHECK(*(*pattern)->interior_edge == 0.01);
}

TEST_CASE("textures: a cut or damaged file is one line with the path and what to do, wherever it is cut") {
  const TemporaryFolder folder;
  const std::string path = folder.file("cut.png");
  TextureConfig config;
  config.exterior = path;
  int refused = 0;
  for (int tenth = 0; tenth < 10; ++tenth) {
    REQUIRE(write_png(path, noise(64, 64)).ok());
    std::filesystem::resize_file(path, std::filesystem::file_size(path) * static_cast<std::uintmax_t>(tenth) / 10);
    const auto read = load_textures(config);
    REQUIRE(!read.ok());
    CHECK(read.error().code == ErrorCode::bad_input);
    const std::string text = read.error().text();
    CHECK_MESSAGE(text.starts_with(path + ": "), text);
    CHECK_MESSAGE((text.find("save the image again") != std::string::npos || text.find("convert it to PNG") != std::string::npos), text);
    CHECK(text.find('\n') == std::string::npos);
    ++refused;
  }
  CHECK(refused == 10);
  REQUIRE(write_png(path, noise(64, 64)).ok());
  CHECK(load_textures(config).ok());
  config.exterior.clear();
  config.interior = path;  // flat
  const auto flat = load_textures(config);
  REQUIRE(!flat.ok());
  CHECK(flat.error().text().find("square slices") != std::string::npos);
}
