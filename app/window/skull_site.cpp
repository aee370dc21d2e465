#include "app/window/skull_site.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/config/toml_messages.h"

namespace burrhole {
namespace {

constexpr double kFar = 0.5;      // [m] of the start of the ray to a region
constexpr double kRegion = 46.0;  // [mm] edge of the bone that is refined and drilled

}  // namespace

const std::array<SkullRegion, 6>& skull_regions() noexcept {
  static const std::array<SkullRegion, 6> kRegions{{{"left frontal", glm::normalize(Vec3(0.30, -0.55, 0.78))},
                                                    {"right frontal", glm::normalize(Vec3(-0.30, -0.55, 0.78))},
                                                    {"left parietal", glm::normalize(Vec3(0.75, 0.35, 0.55))},
                                                    {"right parietal", glm::normalize(Vec3(-0.75, 0.35, 0.55))},
                                                    {"left occipital", glm::normalize(Vec3(0.35, 0.90, 0.25))},
                                                    {"right occipital", glm::normalize(Vec3(-0.35, 0.90, 0.25))}}};
  return kRegions;
}

std::optional<Vec3> find_region(const BoneModel& bone, const SkullRegion& region) {
  return find_bone(bone, braincase_middle(bone) + kFar * region.outward, -region.outward);
}

std::string site_scene(const DrillSite& site, const SkullSource& source) {
  std::string volume = fmt::format("source = {}\n", toml_string(source.link.empty() ? source.path : source.link));
  if (!source.series.empty()) volume += fmt::format("series = {}\n", toml_string(source.series));
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
      "{}\n"
      "[hand]\nkind = \"script\"\npush_N = 28.0\n\n"
      "[contact]\nmodel = \"surface\"\n\n"
      "[erosion]\nlaw = \"rate\"\n\n"
      "[display]\nmethod = \"raycast\"\n\n"
      "[record]\n\n"
      "[outcome]\nplunge_limit_mm = 1.5               # of a drill without a clutch, as app/scenes/head_phantom.toml says\n",
      toml_string("Burrhole in " + printable_text(path.filename().string())), volume, approach_text(site));
}

}  // namespace burrhole
