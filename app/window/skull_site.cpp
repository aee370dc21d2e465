#include "app/window/skull_site.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/bounds.h"
#include "core/base/units.h"
#include "core/measure/approach.h"
#include "core/measure/approach_check.h"

namespace burrhole {
namespace {

constexpr double kStep = 0.5;           // [voxels] between two samples of a ray, at most
constexpr int kBisections = 20;         // of the place between two samples
constexpr double kFootprint = 6.0e-3;   // [m] radius in which the normal is found: that of a 14 mm perforator, without its edge
constexpr double kAbove = 12.0e-3;      // [m] start of the rays of disc_normal() above the point
constexpr double kBraincase = 75.0e-3;  // [m] of the middle of the braincase below the highest bone
constexpr double kHeadWidth = 0.11;     // [m] a bone that is wider and longer is a head
constexpr double kFar = 0.5;            // [m] of the start of the ray to a region
constexpr double kRegion = 46.0;        // [mm] edge of the bone that is refined and drilled

/// @returns the part [enter, leave] of a ray in a box; enter > leave if there is none.
std::pair<double, double> clip(const Vec3& from, const Vec3& direction, const Vec3& lo, const Vec3& hi) {
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  for (int c = 0; c < 3; ++c) {
    if (direction[c] == 0.0) {
      if (from[c] < lo[c] || from[c] > hi[c]) return {1.0, 0.0};
      continue;
    }
    const double a = (lo[c] - from[c]) / direction[c], b = (hi[c] - from[c]) / direction[c];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return {enter, leave};
}

/// Two vectors of length 1 that are perpendicular to n and to each other.
std::pair<Vec3, Vec3> across(const Vec3& n) {
  const Quat turn = rotation_from_z(n);
  return {turn * Vec3(1.0, 0.0, 0.0), turn * Vec3(0.0, 1.0, 0.0)};
}

/// A point of the surface: place in the plane across `outward`, and height along it [m].
struct Height {
  double u, v, h;
};

std::vector<Height> heights_around(const BoneModel& bone, const Vec3& at, const Vec3& outward, double radius) {
  const auto sides = across(outward);
  const Vec3 &right = sides.first, &up = sides.second;
  std::vector<Height> out;
  const auto add = [&](double u, double v) {
    if (const auto hit = find_bone(bone, at + u * right + v * up + kAbove * outward, -outward))
      if (const double h = glm::dot(*hit - at, outward); std::abs(h) < radius) out.push_back({u, v, h});
  };
  add(0.0, 0.0);
  for (const auto& [share, count] : {std::pair(0.5, 8), std::pair(1.0, 16)})
    for (int n = 0; n < count; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / count;
      add(share * radius * std::cos(angle), share * radius * std::sin(angle));
    }
  return out;
}

/// Least squares h = a + b u + c v. @returns (b, c); nothing if the points lie on a line.
std::optional<glm::dvec2> slopes_of(const std::vector<Height>& points) {
  glm::dmat3 normal(0.0);
  Vec3 right(0.0);
  for (const Height& p : points) {
    const Vec3 row(1.0, p.u, p.v);
    normal += glm::outerProduct(row, row);
    right += row * p.h;
  }
  const double size = normal[0][0] * normal[1][1] * normal[2][2];
  if (!(std::abs(glm::determinant(normal)) > 1e-6 * size)) return std::nullopt;
  const Vec3 fit = glm::inverse(normal) * right;
  return glm::dvec2(fit.y, fit.z);
}

/// A TOML string.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    else
      out += c;
  }
  return out + '"';
}

}  // namespace

std::optional<Vec3> find_bone(const BoneModel& bone, const Vec3& from, const Vec3& direction) {
  const Affine index_from_bone = bone.bone_from_index().inverse();
  const Vec3 start = index_from_bone * from, along = index_from_bone.linear * direction;
  const VoxelBox box = bone.bone_box();
  const auto [enter, leave] = clip(start, along, Vec3(box.lo) - 1.5, Vec3(box.hi) + 0.5);
  if (!(enter <= leave)) return std::nullopt;
  const auto inside = [&](double t) { return sample_occupancy(bone, start + t * along) >= 0.5; };
  const double step = kStep / std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z)});
  double before = enter;
  if (inside(before)) return from + before * direction;
  for (double t = enter + step;; t += step) {
    if (inside(t)) {
      for (int n = 0; n < kBisections; ++n) (inside(0.5 * (before + t)) ? t : before) = 0.5 * (before + t);
      return from + t * direction;
    }
    if (t > leave) return std::nullopt;
    before = t;
  }
}

Vec3 disc_normal(const BoneModel& bone, const Vec3& at, const Vec3& outward, double radius) {
  constexpr int kRounds = 4;
  constexpr std::size_t kFewest = 12;  // of 25 points
  Vec3 normal = outward;
  for (int n = 0; n < kRounds; ++n) {
    const std::vector<Height> points = heights_around(bone, at, normal, radius);
    if (points.size() < kFewest) return outward;
    const auto slopes = slopes_of(points);
    if (!slopes) return outward;
    const auto [right, up] = across(normal);
    normal = glm::normalize(normal - slopes->x * right - slopes->y * up);
  }
  return normal;
}

Result<SkullSite> make_site(const BoneModel& bone, const Vec3& at, const Vec3& outward) {
  const Vec3 normal = disc_normal(bone, at, outward, kFootprint);
  const auto approach = make_approach(bone, {.entry = at, .axis = -normal, .place = {}});
  if (!approach) return approach.error();
  if (const auto wrong = leaves_skull(bone, *approach)) return bad_input(*wrong);
  return SkullSite{approach->bone_from_approach.translation, -normal, approach->thickness};
}

const std::array<SkullRegion, 6>& skull_regions() noexcept {
  static const std::array<SkullRegion, 6> kRegions{{{"left frontal", glm::normalize(Vec3(0.30, -0.55, 0.78))},
                                                    {"right frontal", glm::normalize(Vec3(-0.30, -0.55, 0.78))},
                                                    {"left parietal", glm::normalize(Vec3(0.75, 0.35, 0.55))},
                                                    {"right parietal", glm::normalize(Vec3(-0.75, 0.35, 0.55))},
                                                    {"left occipital", glm::normalize(Vec3(0.35, 0.90, 0.25))},
                                                    {"right occipital", glm::normalize(Vec3(-0.35, 0.90, 0.25))}}};
  return kRegions;
}

Vec3 braincase_middle(const BoneModel& bone) {
  const VoxelBox& box = bone.bone_box();
  const Bounds around = bounds_under(bone.bone_from_index(), Bounds{Vec3(box.lo), Vec3(box.hi - 1)});
  Vec3 middle = 0.5 * (around.lo + around.hi);
  const Vec3 size = around.hi - around.lo;
  if (std::min(size.x, size.y) > kHeadWidth) middle.z = around.hi.z - kBraincase;  // also where the scan ends above it
  return middle;
}

std::optional<Vec3> find_region(const BoneModel& bone, const SkullRegion& region) {
  return find_bone(bone, braincase_middle(bone) + kFar * region.outward, -region.outward);
}

std::string site_scene(const SkullSite& site, const SkullSource& source) {
  const Vec3 entry = site.entry / kMillimetre;
  std::string volume = fmt::format("source = {}\n", quoted(source.path));
  if (!source.series.empty()) volume += fmt::format("series = {}\n", quoted(source.series));
  if (!source.unit.empty()) volume += fmt::format("unit = \"{}\"\n", source.unit);
  if (!source.is_bone_model)
    volume +=
        fmt::format("spacing_mm = 0.25\nregion_mm = [{0:.1f}, {0:.1f}, {0:.1f}]      # round the approach; the rest is dropped\n", kRegion);
  const std::filesystem::path path(source.path);
  return fmt::format(
      "# A burrhole at a point that was chosen in a window. Repeat it with `burrhole drill FILE`.\n"
      "title = {}\n"
      "duration_s = 90.0\n\n"
      "[volume]\n{}\n"
      "[tool]\nname = \"perforator_14_11\"\nspin_rpm = 1000.0\n\n"
      "[approach]                          # patient coordinates: left, posterior, superior\n"
      "entry_mm = [{:.3f}, {:.3f}, {:.3f}]\n"
      "axis = [{:.6f}, {:.6f}, {:.6f}]      # square to the bone there\n\n"
      "[hand]\nkind = \"script\"\npush_N = 28.0\n\n"
      "[contact]\nmodel = \"surface\"\n\n"
      "[erosion]\nlaw = \"rate\"\n\n"
      "[display]\nmethod = \"raycast\"\n\n"
      "[record]\n\n"
      "[outcome]\nplunge_limit_mm = 1.5               # of a drill without a clutch, as app/scenes/head_phantom.toml says\n",
      quoted("Burrhole in " + path.filename().string()), volume, entry.x, entry.y, entry.z, site.axis.x, site.axis.y, site.axis.z);
}

}  // namespace burrhole
