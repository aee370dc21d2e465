// Textures of bone without OpenGL: patterns, headers of files, memory, and the maps from the bone frame.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>

#include "app/view/bone_mesh.h"
#include "app/view/texture_file.h"
#include "app/view/texture_pattern.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

Vec3 color(const Rgba8& c) { return {c.r, c.g, c.b}; }

Vec3 mean_color(const std::vector<Rgba8>& pixels) {
  Vec3 sum(0.0);
  for (const Rgba8& p : pixels) sum += color(p);
  return sum / static_cast<double>(pixels.size());
}

/// The greatest mean difference of neighbouring layers along an axis, and that of the last and the first.
struct Steps {
  double within = 0.0, round = 0.0;
};
Steps steps_along(const std::vector<Rgba8>& pixels, const Vec3i& dims, int axis) {
  const VoxelBox all{Vec3i(0), dims};
  std::vector<double> sums(static_cast<std::size_t>(dims[axis]));
  for_each_voxel(all, [&](const Vec3i& v) {
    Vec3i next = v;
    next[axis] = (v[axis] + 1) % dims[axis];
    sums[static_cast<std::size_t>(v[axis])] += glm::length(color(pixels[all.offset_of(v)]) - color(pixels[all.offset_of(next)]));
  });
  return {*std::max_element(sums.begin(), sums.end() - 1), sums.back()};
}

std::string be32(std::uint32_t n) {
  return {static_cast<char>(n >> 24), static_cast<char>(n >> 16), static_cast<char>(n >> 8), static_cast<char>(n)};
}

std::string write_header(const TemporaryFolder& folder, std::uint32_t width, std::uint32_t height, std::size_t bytes = 33) {
  std::string text = std::string("\x89PNG\r\n\x1a\n", 8) + be32(13) + "IHDR" + be32(width) + be32(height) + std::string(9, '\x08');
  text.resize(bytes);
  std::ofstream(folder.file("t.png"), std::ios::binary) << text;
  return folder.file("t.png");
}

TEST_CASE("texture pattern: each is the same again, differs inside from outside and from the others, and tiles where it repeats") {
  std::vector<Vec3> means;
  REQUIRE(pattern_names() == std::vector<std::string>{"bone", "apple", "cucumber"});
  for (const std::string& name : pattern_names()) {
    CAPTURE(name);
    const Image outside = make_exterior_pattern(name);
    const VolumeImage inside = make_interior_pattern(name);
    REQUIRE(outside.pixels.size() == std::size_t{kPatternImageSide} * kPatternImageSide);
    REQUIRE(inside.pixels.size() == VoxelBox{Vec3i(0), inside.dims}.count());
    CHECK(outside.pixels == make_exterior_pattern(name).pixels);
    CHECK(std::ranges::all_of(outside.pixels, [](const Rgba8& p) { return p.a == 255; }));
    means.push_back(mean_color(outside.pixels));
    means.push_back(mean_color(inside.pixels));
    for (const int axis : {0, 1}) {
      const Steps steps = steps_along(outside.pixels, {outside.width, outside.height, 1}, axis);
      CHECK(steps.round <= 1.2 * steps.within);  // a seam is a step as between other rows
    }
    if (!pattern_scale(name).interior_edge) continue;
    for (const int axis : {0, 1, 2}) {
      const Steps steps = steps_along(inside.pixels, inside.dims, axis);
      CHECK(steps.round <= 1.2 * steps.within);
    }
  }
  for (std::size_t n = 0; n < means.size(); ++n)
    for (std::size_t m = 0; m < n; ++m) CHECK(glm::length(means[n] - means[m]) > 20.0);
  // A part of an image that tiles does not tile: what the check above finds.
  Image part = make_exterior_pattern("bone");
  part.height = 100;
  part.pixels.resize(std::size_t{kPatternImageSide} * 100);
  const Steps cut = steps_along(part.pixels, {part.width, part.height, 1}, 1);
  CHECK(cut.round > 1.2 * cut.within);
}

TEST_CASE("texture file: the header gives the texels; what is no texture is refused in one line with what to do") {
  const TemporaryFolder folder;
  const auto image = [](const std::string& path) { return read_texture_header(path, TextureKind::exterior); };
  const auto volume = [](const std::string& path) { return read_texture_header(path, TextureKind::interior); };
  REQUIRE(image(write_header(folder, 640, 480)).ok());
  CHECK(*image(write_header(folder, 640, 480)) == Vec3i(640, 480, 1));
  CHECK(*image(write_header(folder, 4096, 1)) == Vec3i(4096, 1, 1));
  CHECK(*volume(write_header(folder, 64, 64 * 20)) == Vec3i(64, 64, 20));
  CHECK(*volume(write_header(folder, 256, 256 * 256)) == Vec3i(256));
  const auto refused = [](const Result<Vec3i>& found, const std::string& words) {
    REQUIRE(!found.ok());
    CHECK(found.error().code == ErrorCode::bad_input);
    CHECK_MESSAGE(found.error().message.find(words) != std::string::npos, found.error().message);
    CHECK(found.error().message.find('\n') == std::string::npos);
  };
  refused(image(write_header(folder, 16384, 16384)), "16384 x 16384 pixels, more than the 4096 of an edge");
  refused(image(write_header(folder, 4097, 1)), "scale the image down");
  refused(image(write_header(folder, 0xffffffffu, 2)), "4294967295 x 2");
  refused(image(write_header(folder, 0, 5)), "no pixels");
  refused(volume(write_header(folder, 0, 0)), "no pixels");
  refused(volume(write_header(folder, 64, 64)), "a volume is a column of at least two square slices");
  refused(volume(write_header(folder, 64, 65)), "use a flat image as exterior_texture");
  refused(volume(write_header(folder, 0xfffffffeu, 2)), "square slices");
  refused(volume(write_header(folder, 257, 2 * 257)), "more than the 256 of an edge");
  refused(volume(write_header(folder, 1, 257)), "257 slices of 1 x 1");
  for (const std::size_t bytes : {0, 7, 8, 23}) refused(image(write_header(folder, 640, 480, bytes)), "not a PNG image: convert it to PNG");
  std::ofstream(folder.file("scan.png")) << "NRRD0004\ntype: float\ndimension: 3\nsizes: 4 4 4\n";
  refused(volume(folder.file("scan.png")), "not a PNG image");
  refused(image(folder.path().string()), "folder");
  refused(image(folder.file("none.png")), "No such file");
  refused(image("/dev/zero"), "is a device");
}

TEST_CASE("texture file: memory counts both textures with their coarser levels and a copy, and nothing without them") {
  const TemporaryFolder folder;
  CHECK(texture_bytes({}) == 0);
  TextureConfig config;
  config.exterior = write_header(folder, 300, 200);
  CHECK(texture_bytes(config) == 2 * 240'000 + 80'000);
  config.interior = "bone";
  constexpr std::uint64_t kVolume = std::uint64_t{4} * kPatternVolumeSide * kPatternVolumeSide * kPatternVolumeSide;
  CHECK(texture_bytes(config) == 2 * 240'000 + 80'000 + 2 * kVolume + kVolume / 7);
  CHECK(mesh_bytes(1'000'000, true) == mesh_bytes(1'000'000) + 1'000'000);
}

TEST_CASE("texture maps: a volume without an edge spans the box, and the texture's z is the axis") {
  BoneTextures textures;
  const Bounds box{{-0.01, 0.02, 0.0}, {0.03, 0.04, 0.05}};
  for (const int axis : {0, 1, 2}) {
    textures.axis = axis;
    const TextureMaps maps = make_texture_maps(textures, box);
    for (const Vec3& corner : {box.lo, box.hi, 0.5 * (box.lo + box.hi)}) {
      const Vec3 share = (corner - box.lo) / (box.hi - box.lo);
      for (int row = 0; row < 3; ++row)
        CHECK(std::abs(glm::dot(maps.interior[row], glm::dvec4(corner, 1.0)) - share[(axis + 1 + row) % 3]) < 1e-12);
    }
    CHECK(maps.exterior[2][axis] == 1.0 / textures.exterior_edge);
  }
  textures.interior_edge = 0.012;
  CHECK(std::abs(glm::dot(make_texture_maps(textures, box).interior[2], glm::dvec4(0.0, 0.0, 0.006, 1.0)) - 0.5) < 1e-12);
}

}  // namespace
}  // namespace burrhole::test
