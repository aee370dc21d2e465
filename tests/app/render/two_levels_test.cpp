// A bone in two levels beside the same bone in one texture: what is hit, where, and how the seam looks.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/view/detail.h"
#include "app/view/texels.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/drill_scene.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kWidth = 480, kHeight = 360;
constexpr int kFactor = 3;

/// A piece of skull of 30 mm at 0.25 mm, and a ball of 25 mm.
constexpr const char* kPatch = R"(source = "phantom:skull_patch"
spacing_mm = 0.25
extent_mm = [30.0, 30.0, 16.0]
above_mm = 3.0
)";
constexpr const char* kBall = R"(source = "phantom:sphere"
spacing_mm = 0.25
extent_mm = [30.0, 30.0, 20.0]
above_mm = 3.0
radius_mm = 25.0
)";
struct Subject {
  Subject(const char* volume, double radius) : loaded(load_small({.volume = volume})), radius_(radius) {
    auto made = Voxmap::create(loaded.bone, {});
    REQUIRE(made.ok());
    voxmap = std::make_unique<Voxmap>(std::move(made).value());
    auto coarsened = CoarseBone::create(*loaded.bone, kFactor);
    REQUIRE(coarsened.ok());
    coarse = std::make_unique<CoarseBone>(std::move(coarsened).value());
    const Vec3 centre = loaded.bone->bone_from_index().inverse() * Vec3(1e-3, -1.5e-3, -1e-3);
    grid = place_detail(loaded.bone->dims(), kFactor, centre, Vec3(60));
  }
  [[nodiscard]] VolumeView one() const { return make_volume_view(*voxmap, true); }
  /// @param off [voxels] by which the bone in the detail is below its place: 0 as in the program.
  [[nodiscard]] VolumeView two(int off = 0) const {
    VolumeView view = make_volume_view(coarse->drawn(*voxmap), coarse->loaded().bounds(), true);
    DetailView part = make_detail_view(grid, *coarse, *voxmap, true);
    std::vector<std::uint16_t>& field = part.volume.field;
    const auto layer = static_cast<std::ptrdiff_t>(part.volume.dims.x) * part.volume.dims.y;
    std::copy(field.begin() + off * layer, field.end(), field.begin());
    view.detail = std::make_shared<const DetailView>(std::move(part));
    return view;
  }

  /// [m] of a point in the bone frame from the outer surface, a sphere whose top is the origin.
  [[nodiscard]] double distance(const Vec3& p) const { return glm::length(p + Vec3(0, 0, radius_)) - radius_; }

  LoadedScene loaded;
  std::unique_ptr<Voxmap> voxmap;
  std::unique_ptr<CoarseBone> coarse;
  DetailGrid grid;

 private:
  double radius_;
};

FrameView view_from(const Vec3& eye) {
  FrameView view;
  view.camera = {.eye = eye, .target = {0.0, 0.0, -2e-3}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.4};
  return view;
}

const std::vector<Vec3> kEyes{{0.02, -0.05, 0.045}, {0.0, -0.001, 0.07}, {-0.045, 0.03, 0.03}};

/// How far [voxels] a point is from the nearest face of the part, on either side.
double from_faces(const DetailGrid& grid, const Vec3f& hit) {
  const Vec3 a = Vec3(hit) - Vec3(grid.box.lo), b = Vec3(grid.box.hi - 1) - Vec3(hit);
  const double inside = std::min({a.x, a.y, a.z, b.x, b.y, b.z});
  return std::abs(inside);
}

struct Seam {
  int missed = 0, hits = 0;  ///< pixels that one picture hits and the other does not; pixels that one texture hits
  int pixels = 0, off = 0;   ///< near the seam; of them more than 4 levels from one texture
  double step = 0.0;         ///< [coarse voxels] largest step of the error of the surface between neighbours on either side of the seam
  double beside = 0.0;       ///< [coarse voxels] the same between neighbours that both show coarse bone
};

Seam measure(const Subject& subject, const VolumeView& two, const RenderOptions& options, const FrameView& view) {
  const auto probe = [&](const VolumeView& volume) {
    Renderer renderer = require_renderer(options);
    REQUIRE(renderer.set_volume(volume).ok());
    auto made = renderer.probe(view, kWidth, kHeight);
    REQUIRE(made.ok());
    return std::move(made).value();
  };
  const FrameProbe one = probe(subject.one()), both = probe(two);
  const auto is_near = [&](std::size_t n) { return both.hit[n] == 1 && from_faces(subject.grid, both.hit_index[n]) < 2.0 * kFactor; };
  const Affine& bone_from_index = subject.loaded.bone->bone_from_index();
  const auto distance = [&](const Vec3f& hit) { return subject.distance(bone_from_index * Vec3(hit)); };
  // On the outer surface, whose closed form is known.
  const auto is_outer = [&](std::size_t n) { return one.hit[n] == 1 && std::abs(distance(one.hit_index[n])) < 0.05e-3; };
  const auto error = [&](std::size_t n) { return distance(both.hit_index[n]) / (kFactor * 0.25e-3); };
  // 0 beside the detail, 1 where both levels are drawn, 2 where only the detail is.
  const auto zone = [&](std::size_t n) {
    const Vec3 hit(both.hit_index[n]), lo(subject.grid.box.lo), hi(subject.grid.box.hi - 1);
    const auto is_inside = [&](double margin) {
      return glm::all(glm::greaterThan(hit, lo + margin)) && glm::all(glm::lessThan(hit, hi - margin));
    };
    return is_inside(kFactor) ? 2 : is_inside(0.0) ? 1 : 0;
  };
  Seam seam;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const auto n = static_cast<std::size_t>(y * kWidth + x);
      seam.hits += one.hit[n];
      seam.missed += one.hit[n] != both.hit[n] ? 1 : 0;
      if (!is_near(n) || !is_outer(n)) continue;
      ++seam.pixels;
      const Rgba8 &a = one.image.pixels[n], &b = both.image.pixels[n];
      seam.off += std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)}) > 4 ? 1 : 0;
      for (const std::size_t next : {n + 1, n + kWidth}) {
        if (x + 1 == kWidth || y + 1 == kHeight || !is_near(next) || !is_outer(next)) continue;
        const double step = std::abs(error(n) - error(next));
        if (zone(n) != zone(next)) seam.step = std::max(seam.step, step);
        if (zone(n) == 0 && zone(next) == 0) seam.beside = std::max(seam.beside, step);
      }
    }
  return seam;
}

RenderOptions shipped() { return {.appearance = {.tissue = true, .occlusion = true}}; }

}  // namespace

TEST_CASE("two levels: no seam in depth and light, beside one texture") {
  for (const auto& [volume, radius] : {std::pair(kPatch, 80e-3), std::pair(kBall, 25e-3)}) {
    const Subject subject(volume, radius);
    for (const Vec3& eye : kEyes) {
      const Seam seam = measure(subject, subject.two(), shipped(), view_from(eye));
      MESSAGE(seam.hits, " hits, ", seam.missed, " missed, near the seam ", seam.pixels, ", off ", seam.off, ", step ", seam.step,
              " beside ", seam.beside);
      CHECK(seam.pixels > 500);
      CHECK(seam.step < 0.1);
      CHECK(seam.off < 0.05 * seam.pixels);
    }
  }
}

TEST_CASE("two levels: a detail one voxel off its place is seen") {
  const Subject subject(kPatch, 80e-3);
  const Seam seam = measure(subject, subject.two(1), shipped(), view_from(kEyes[0]));
  MESSAGE("off by a voxel: off ", seam.off, " of ", seam.pixels, ", step ", seam.step, " beside ", seam.beside);
  CHECK(seam.step > 0.1);
}

TEST_CASE("two levels: shadow and cut pass through the seam") {
  const Subject subject(kPatch, 80e-3);
  RenderOptions options = shipped();
  options.appearance.shadow = options.appearance.specular = true;
  FrameView view = view_from({0.01, -0.06, 0.03});
  view.cut = FrameView::Cut{{0, -1, 0}, 0.0};
  const Seam seam = measure(subject, subject.two(), options, view);
  MESSAGE(seam.hits, " hits, ", seam.missed, " missed, near the seam ", seam.pixels, ", off ", seam.off, ", step ", seam.step, " beside ",
          seam.beside);
  CHECK(seam.off < 0.05 * seam.pixels);
}

TEST_CASE("two levels: the shadow of a tool crosses the seam as on one volume") {
  const Subject subject(kPatch, 80e-3);
  RenderOptions options = shipped();
  options.appearance.shadow = true;
  FrameView view = view_from(kEyes[0]);
  const auto shaded = [&](const VolumeView& volume, FrameProbe* probe) {
    Renderer renderer = require_renderer(options);
    REQUIRE(renderer.set_volume(volume).ok());
    REQUIRE(renderer.set_tool(square(4e-3, 0.0)).ok());
    view.world_from_tool.reset();
    const auto without = renderer.draw(view, kWidth, kHeight);
    view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(10e-3, -6e-3, 7e-3)};
    const auto with = renderer.draw(view, kWidth, kHeight);
    auto hits = renderer.probe(view, kWidth, kHeight);
    REQUIRE((without.ok() && with.ok() && hits.ok()));
    std::vector<bool> out;
    for (std::size_t n = 0; n < with->pixels.size(); ++n) out.push_back(hits->hit[n] == 1 && with->pixels[n].r + 20 < without->pixels[n].r);
    if (probe != nullptr) *probe = std::move(*hits);
    return out;
  };
  FrameProbe probe;
  const std::vector<bool> one = shaded(subject.one(), &probe), two = shaded(subject.two(), nullptr);
  int both = 0, differing = 0, inside = 0, outside = 0;
  for (std::size_t n = 0; n < one.size(); ++n) {
    both += one[n] && two[n] ? 1 : 0;
    differing += one[n] != two[n] ? 1 : 0;
    if (!two[n]) continue;
    const Vec3 hit(probe.hit_index[n]);
    const bool in_detail =
        glm::all(glm::greaterThan(hit, Vec3(subject.grid.box.lo))) && glm::all(glm::lessThan(hit, Vec3(subject.grid.box.hi)));
    ++(in_detail ? inside : outside);
  }
  MESSAGE(both, " pixels in both shadows, ", differing, " in one, ", inside, " on the detail, ", outside, " beside it");
  CHECK(inside > 300);
  CHECK(outside > 300);
  CHECK(differing < both / 50);
}

TEST_CASE("two levels: a tool is hidden by the bone of both, and hides it") {
  const Subject subject(kPatch, 80e-3);
  Renderer renderer = require_renderer(shipped());
  REQUIRE(renderer.set_volume(subject.two()).ok());
  REQUIRE(renderer.set_tool(square(12e-3, 0.0)).ok());  // over detail and whole
  FrameView view = view_from(kEyes[0]);
  const auto drawn = [&] {
    const auto image = renderer.draw(view, kWidth, kHeight);
    REQUIRE(image.ok());
    return *image;
  };
  const Image without = drawn();
  view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, -4e-3)};  // inside the bone
  CHECK(drawn().pixels == without.pixels);
  view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, 1e-3)};
  const Image above = drawn();
  const auto probe = renderer.probe(view, kWidth, kHeight);
  REQUIRE(probe.ok());
  CHECK(above.pixels != without.pixels);
  int differing = 0;
  for (std::size_t n = 0; n < above.pixels.size(); ++n) differing += above.pixels[n] == probe->image.pixels[n] ? 0 : 1;
  CHECK(differing < kWidth * kHeight / 1000);
}
