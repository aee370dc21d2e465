#include "volumes/phantom/phantom_spec.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "volumes/phantom/head_bone.h"

namespace burrhole {
namespace {

/// Set of kinds, one bit each.
using Kinds = unsigned;
constexpr Kinds only(PhantomKind kind) { return 1u << static_cast<unsigned>(kind); }
constexpr Kinds kPatch = only(PhantomKind::skull_patch), kBlock = only(PhantomKind::block), kPlate = only(PhantomKind::plate),
                kSphere = only(PhantomKind::sphere), kWedge = only(PhantomKind::wedge), kPit = only(PhantomKind::pit),
                kCapsule = only(PhantomKind::capsule), kHead = only(PhantomKind::head);
constexpr Kinds kGrid = kPatch | kBlock | kPlate | kSphere | kWedge | kPit | kCapsule, kLayers = kPatch | kHead, kEvery = kGrid | kHead;

constexpr std::array<std::string_view, 8> kNames{"skull_patch", "block", "plate", "sphere", "wedge", "pit", "capsule", "head"};

/// One scalar key: its numbers are as written in a file, `to_si` makes them SI.
struct NumberField {
  const char* key;
  double PhantomSpec::*member;
  double fallback, min, max;
  bool min_open;
  double to_si;
  Kinds kinds;
  const char* about;
};

constexpr double kMm = kMillimetre;
using S = PhantomSpec;
constexpr std::array kNumbers{
    NumberField{"spacing_mm", &S::pitch, 0.25, 0.0, 5.0, true, kMm, kEvery, "edge of a voxel"},
    NumberField{"above_mm", &S::above, 2.0, 0.0, 100.0, false, kMm, kGrid,
                "height of the grid above the origin, along +z, the outward normal"},
    NumberField{"noise", &S::noise, 0.0, 0.0, 0.5, false, 1.0, kGrid,
                "a: in each voxel, occupancy and hardness are multiplied by one random factor each, uniform in [1 - 2 a, 1)"},
    NumberField{"thickness_mm", &S::thickness, 7.04, 0.0, 100.0, true, kMm, kLayers | kPlate | kPit, "thickness of the bone"},
    NumberField{"hardness", &S::hardness, 0.8, 0.0, 1.0, false, 1.0, kGrid & ~kPatch, "relative mineral density of the bone"},
    NumberField{"curvature_mm", &S::curvature, 80.0, 0.0, 1000.0, true, kMm, kPatch, "radius of the outer surface"},
    NumberField{"outer_table_mm", &S::outer_table, 2.4, 0.0, 100.0, false, kMm, kLayers, "thickness of the outer table"},
    NumberField{"inner_table_mm", &S::inner_table, 1.7, 0.0, 100.0, false, kMm, kLayers, "thickness of the inner table"},
    NumberField{"dura_mm", &S::dura, 0.5, 0.0, 10.0, false, kMm, kLayers, "thickness of the dura"},
    NumberField{"rim_mm", &S::rim_radius, 0.0, 0.0, 500.0, false, kMm, kPatch,
                "distance from the z axis at which bone, dura and brain end; 0: at the end of the grid"},
    NumberField{"pore_mm", &S::pore_size, 1.2, 0.0, 20.0, true, kMm, kLayers, "mean width of the pores of the diploe"},
    NumberField{"porosity", &S::porosity, 0.4, 0.0, 1.0, false, 1.0, kLayers, "pores' share of the diploe's volume"},
    NumberField{"table_hardness", &S::table_hardness, 0.9, 0.0, 1.0, false, 1.0, kLayers, "relative mineral density of the tables"},
    NumberField{"trabecula_hardness", &S::trabecula_hardness, 0.45, 0.0, 1.0, false, 1.0, kLayers,
                "relative mineral density of the diploe between its pores"},
    NumberField{"pore_hardness", &S::pore_hardness, 0.12, 0.0, 1.0, false, 1.0, kLayers,
                "relative mineral density of the diploe in its pores"},
    NumberField{"surroundings_mm", &S::surroundings, 1.5, 0.0, 5.0, true, kMm, kHead,
                "edge of the voxels of the head outside the region, rounded to whole voxels; they are drawn only"},
    NumberField{"radius_mm", &S::sphere_radius, 6.0, 0.0, 250.0, true, kMm, kSphere | kCapsule, "radius of the sphere or capsule"},
    NumberField{"length_mm", &S::capsule_length, 30.0, 0.0, 500.0, true, kMm, kCapsule,
                "length of the capsule along x, with its round ends"},
    NumberField{"wedge_deg", &S::wedge_angle, 90.0, 20.0, 170.0, false, kDegree, kWedge, "angle inside the bone between the faces"},
    NumberField{"hole_radius_mm", &S::hole_radius, 3.0, 0.0, 100.0, true, kMm, kPit, "radius of the blind hole"},
    NumberField{"hole_depth_mm", &S::hole_depth, 4.0, 0.0, 100.0, true, kMm, kPit, "depth of the blind hole"},
};

/// One key of three lengths [mm], each in (0, 500].
struct LengthsField {
  const char* key;
  Vec3 PhantomSpec::*member;
  Vec3 fallback;
  Kinds kinds;
  const char* about;
};
constexpr double kMaxLengthMm = 500.0;
const std::array kLengths{
    LengthsField{"extent_mm", &S::extent, Vec3(30.0, 30.0, 16.0), kGrid, "size of the grid along x, y, z"},
    LengthsField{"region_mm", &S::region, Vec3(40.0, 40.0, 28.0), kHead,
                 "size of the box round the entry in which bone is felt and drilled, across and along the axis; the rest of the head is "
                 "drawn only"},
    LengthsField{"block_mm", &S::block_size, Vec3(20.0, 20.0, 8.0), kBlock, "size of the block along x, y, z"},
};

/// An error, printed as "volume.<key> = <value> <what>"; without the value if the key is an array.
struct Finding {
  const char* key;
  std::optional<double> value;  ///< as written
  std::string what;
};
using Findings = std::vector<Finding>;

std::string range_text(double min, double max, bool min_open) { return fmt::format("{}{:g}, {:g}]", min_open ? '(' : '[', min, max); }

bool in_range(double written, double min, double max, bool min_open) {
  // A value at the bound may differ from it by a rounding error after the conversion to SI and back.
  const double slack = 1e-12 * std::max(std::abs(min), std::abs(max));
  return std::isfinite(written) && (min_open ? written > min : written >= min - slack) && written <= max + slack;
}

void check_ranges(const PhantomSpec& spec, Findings& found) {
  const Kinds kind = only(spec.kind);
  for (const NumberField& f : kNumbers) {
    const double written = spec.*f.member / f.to_si;
    if ((f.kinds & kind) != 0 && !in_range(written, f.min, f.max, f.min_open))
      found.push_back({f.key, written, "must be in " + range_text(f.min, f.max, f.min_open)});
  }
  for (const LengthsField& f : kLengths) {
    const Vec3 v = spec.*f.member / kMm;
    const bool good =
        in_range(v.x, 0.0, kMaxLengthMm, true) && in_range(v.y, 0.0, kMaxLengthMm, true) && in_range(v.z, 0.0, kMaxLengthMm, true);
    if ((f.kinds & kind) != 0 && !good)
      found.push_back({f.key, {}, fmt::format("= [{:g}, {:g}, {:g}] must each be in (0, {:g}]", v.x, v.y, v.z, kMaxLengthMm)});
  }
  if (spec.seed < 0) found.push_back({"seed", static_cast<double>(spec.seed), "must not be negative"});
}

void check_grid(const PhantomSpec& spec, Findings& found) {
  const Vec3 n = spec.extent / spec.pitch;
  const double count = n.x * n.y * n.z;
  if (count > kMaxPhantomVoxels)
    found.push_back(
        {"spacing_mm", spec.pitch / kMm,
         fmt::format("with volume.extent_mm makes {:.0f} x {:.0f} x {:.0f} = {:.3g} voxels, more than the {:.3g} that are built: use "
                     "a larger spacing or a smaller extent",
                     n.x, n.y, n.z, count, kMaxPhantomVoxels)});
  if (spec.above >= spec.extent.z)
    found.push_back({"above_mm", spec.above / kMm,
                     fmt::format("must be less than volume.extent_mm[2] = {:g}, or no bone is in the grid", spec.extent.z / kMm)});
}

/// The thinnest dimension of the bone and the key that sets it.
struct Thinnest {
  const char* key;
  double size;  ///< [m]
};
Thinnest thinnest_part(const PhantomSpec& spec) {
  switch (spec.kind) {
    case PhantomKind::block:
      return {"block_mm", std::min({spec.block_size.x, spec.block_size.y, spec.block_size.z})};
    case PhantomKind::sphere:
    case PhantomKind::capsule:
      return {"radius_mm", 2.0 * spec.sphere_radius};
    case PhantomKind::wedge:
      return {"extent_mm", spec.extent.z - spec.above};
    case PhantomKind::pit:
      return {"hole_depth_mm", std::min({spec.hole_depth, spec.thickness - spec.hole_depth, 2.0 * spec.hole_radius})};
    case PhantomKind::skull_patch:
    case PhantomKind::head:
    case PhantomKind::plate:
      return {"thickness_mm", spec.thickness};
  }
  return {"", 0.0};
}

void check_resolution(const PhantomSpec& spec, Findings& found) {
  const Thinnest thin = thinnest_part(spec);
  if (thin.size < kMinVoxelsThrough * spec.pitch)
    found.push_back({"spacing_mm", spec.pitch / kMm,
                     fmt::format("is too coarse for the {:g} mm of bone or hole that volume.{} leaves: at most {:g}", thin.size / kMm,
                                 thin.key, thin.size / kMinVoxelsThrough / kMm)});
}

void check_patch(const PhantomSpec& spec, Findings& found) {
  const double rounding = 1e-12;  // [m] tables that fill the whole bone leave no diploe and are valid
  if (spec.outer_table + spec.inner_table > spec.thickness + rounding)
    found.push_back({"outer_table_mm", spec.outer_table / kMm,
                     fmt::format("and volume.inner_table_mm = {:g} must fit in volume.thickness_mm = {:g}", spec.inner_table / kMm,
                                 spec.thickness / kMm)});
  if (spec.kind == PhantomKind::head) return;
  const double below = spec.extent.z - spec.above;
  if (std::max(below, spec.thickness + spec.dura) >= spec.curvature)
    found.push_back({"curvature_mm", spec.curvature / kMm,
                     fmt::format("must be more than the bone with its dura ({:g} mm) and than the grid's depth below the origin ({:g} mm)",
                                 (spec.thickness + spec.dura) / kMm, below / kMm)});
  // Beyond 0.9 the wall of the rim would meet the inner surface at less than 26 degrees, which no grid resolves.
  const double widest = 0.9 * (spec.curvature - spec.thickness);
  const double narrowest = 0.5 * kMinVoxelsThrough * spec.pitch;
  if (spec.rim_radius > 0.0 && (spec.rim_radius > widest || spec.rim_radius < narrowest))
    found.push_back({"rim_mm", spec.rim_radius / kMm, fmt::format("must be 0 (none) or in [{:g}, {:g}]", narrowest / kMm, widest / kMm)});
}

void check_head(const PhantomSpec& spec, Findings& found) {
  // The skull is 5 to 7 mm thick at its sites; cells of bone must not be thinner than coarse voxels.
  if (spec.surroundings < 1.5 * spec.pitch)
    found.push_back(
        {"surroundings_mm", spec.surroundings / kMm, fmt::format("must be at least 1.5 times volume.spacing_mm = {:g}", spec.pitch / kMm)});
  // With 0.5 mm a head has 150 million coarse voxels.
  if (spec.surroundings < 0.5 * kMm) found.push_back({"surroundings_mm", spec.surroundings / kMm, "must be at least 0.5"});
  const Vec3 n = spec.region / spec.pitch;
  if (n.x * n.y * n.z > kMaxPhantomVoxels)
    found.push_back({"spacing_mm", spec.pitch / kMm,
                     fmt::format("with volume.region_mm makes {:.3g} voxels, more than the {:.3g} that are built", n.x * n.y * n.z,
                                 kMaxPhantomVoxels)});
}

void check_plate(const PhantomSpec& spec, Findings& found) {
  const Vec3& n = spec.plate_normal;
  const double length = glm::length(n);
  // 0.05: a plate steeper than 87 degrees has no face within the grid.
  if (!std::isfinite(length) || length <= 0.0 || n.z < 0.05 * length)
    found.push_back({"plate_normal", {}, fmt::format("= [{:g}, {:g}, {:g}] must point up: z at least 0.05 of its length", n.x, n.y, n.z)});
}

void check_capsule(const PhantomSpec& spec, Findings& found) {
  if (spec.capsule_length < 2.0 * spec.sphere_radius)
    found.push_back({"length_mm", spec.capsule_length / kMm,
                     fmt::format("must be at least twice volume.radius_mm = {:g}, for the round ends", spec.sphere_radius / kMm)});
}

void check_pit(const PhantomSpec& spec, Findings& found) {
  if (spec.hole_depth >= spec.thickness)
    found.push_back({"hole_depth_mm", spec.hole_depth / kMm,
                     fmt::format("must be less than volume.thickness_mm = {:g}: the hole is blind", spec.thickness / kMm)});
}

Findings find_errors(const PhantomSpec& spec) {
  Findings found;
  check_ranges(spec, found);
  if (spec.kind == PhantomKind::plate) check_plate(spec, found);
  if (!found.empty()) return found;  // the following checks divide by these numbers and would only repeat the errors
  if (spec.kind == PhantomKind::head)
    check_head(spec, found);
  else
    check_grid(spec, found);
  if (spec.kind == PhantomKind::skull_patch || spec.kind == PhantomKind::head) check_patch(spec, found);
  if (spec.kind == PhantomKind::pit) check_pit(spec, found);
  if (spec.kind == PhantomKind::capsule) check_capsule(spec, found);
  if (found.empty()) check_resolution(spec, found);
  return found;
}

}  // namespace

std::string_view phantom_name(PhantomKind kind) noexcept { return kNames[static_cast<std::size_t>(kind)]; }

std::optional<PhantomKind> find_phantom(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<PhantomKind>(i);
  return std::nullopt;
}

std::vector<std::string> phantom_names() { return {kNames.begin(), kNames.end()}; }

Vec3i phantom_dims(const PhantomSpec& spec) noexcept {
  if (spec.kind == PhantomKind::head) return head_grid(spec).dims;
  // 1e-6 of a voxel: 30 mm / 0.25 mm is 120 voxels for any rounding of the division.
  const Vec3 n = spec.extent / spec.pitch - 1e-6;
  return glm::max(Vec3i(1), Vec3i(static_cast<int>(std::ceil(n.x)), static_cast<int>(std::ceil(n.y)), static_cast<int>(std::ceil(n.z))));
}

Affine phantom_bone_from_index(const PhantomSpec& spec) noexcept {
  if (spec.kind == PhantomKind::head) return head_grid(spec).bone_from_index;
  const Vec3i n = phantom_dims(spec);
  const Vec3 first(-0.5 * (n.x - 1) * spec.pitch, -0.5 * (n.y - 1) * spec.pitch, spec.above - (n.z - 0.5) * spec.pitch);
  return Affine::scaling(spec.pitch, first);
}

Issues validate(const PhantomSpec& spec) {
  Issues issues;
  for (const Finding& f : find_errors(spec)) {
    const std::string value = f.value ? fmt::format(" = {:g}", *f.value) : std::string();
    issues.push_back({ErrorCode::out_of_range, fmt::format("volume.{}{} {}", f.key, value, f.what), {}});
  }
  return issues;
}

PhantomSpec read_phantom(TableReader& volume, std::string_view kind) {
  PhantomSpec spec;
  const std::optional<PhantomKind> found = find_phantom(kind);
  if (!found) {
    const std::optional<std::string> near = nearest_name(kind, phantom_names());
    volume.fault("source", fmt::format("names no phantom{}; known: {}", near ? fmt::format(": did you mean \"phantom:{}\"?", *near) : "",
                                       fmt::join(kNames, ", ")));
  }
  spec.kind = found.value_or(PhantomKind::skull_patch);
  // After an unknown kind all keys count as known, so that one typing error gives one message.
  const Kinds kinds = found ? only(spec.kind) : kEvery;
  for (const NumberField& f : kNumbers)
    if ((f.kinds & kinds) != 0)
      spec.*f.member =
          volume.number(f.key, {.fallback = f.fallback, .min = f.min, .max = f.max, .min_open = f.min_open, .to_si = f.to_si}, f.about);
  for (const LengthsField& f : kLengths)
    if ((f.kinds & kinds) != 0)
      spec.*f.member =
          volume.vector(f.key, f.fallback, {.fallback = {}, .min = 0.0, .max = kMaxLengthMm, .min_open = true, .to_si = kMm}, f.about);
  if ((kPlate & kinds) != 0)
    spec.plate_normal = volume.vector("plate_normal", Vec3(0.0, 0.0, 1.0), {}, "outward normal of the plate, of any length; z above 0");
  spec.seed = volume.integer("seed", 1, 0, std::numeric_limits<std::int64_t>::max(), "seed of pores and noise");
  if (found)
    for (const Finding& f : find_errors(spec)) volume.fault(f.key, f.what);
  return spec;
}

}  // namespace burrhole
