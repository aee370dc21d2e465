#include "volumes/read/raw_sidecar.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kUnitLength = 1e-3;            ///< a direction written with four digits may deviate by this from length 1
constexpr double kMostOffset = 1099511627776.;  ///< [bytes] 2^40

const std::array<std::pair<const char*, PixelType>, 10> kTypes{{{"uint8", PixelType::u8},
                                                                {"int8", PixelType::i8},
                                                                {"uint16", PixelType::u16},
                                                                {"int16", PixelType::i16},
                                                                {"uint32", PixelType::u32},
                                                                {"int32", PixelType::i32},
                                                                {"uint64", PixelType::u64},
                                                                {"int64", PixelType::i64},
                                                                {"float32", PixelType::f32},
                                                                {"float64", PixelType::f64}}};

void read_form(TableReader& root, PixelForm& form) {
  const std::string name = root.choice("type", std::nullopt, raw_type_names(), "what one voxel is stored as");
  for (const auto& [known, type] : kTypes)
    if (name == known) form.type = type;
  const std::optional<std::string> fallback = bytes_of(form.type) == 1 ? std::optional<std::string>("little") : std::nullopt;
  form.big_endian = root.choice("byte_order", fallback, {"little", "big"}, "order of the bytes of one number") == "big";
  form.slope = root.number("slope", {.fallback = 1.0}, "factor of the stored numbers, applied before the intercept");
  form.intercept = root.number("intercept", {.fallback = 0.0}, "added to the stored numbers after the slope");
  if (form.slope == 0.0) root.fault("slope", "would make every voxel equal");
}

void read_grid(TableReader& root, ImageHead& image) {
  const auto sizes =
      root.numbers("dims", std::nullopt, 3, {.min = 1.0, .max = 2147483647.0}, "numbers of voxels along i, j, k; i runs fastest");
  if (std::any_of(sizes.begin(), sizes.end(), [](double size) { return size != std::floor(size); }))
    root.fault("dims", "must be whole numbers");
  else if (const auto error = dims_error(std::llround(sizes[0]), std::llround(sizes[1]), std::llround(sizes[2])))
    root.fault("dims", fmt::format("are not read: {}", *error));
  image.dims = Vec3i(sizes[0], sizes[1], sizes[2]);
  const Vec3 spacing = root.vector("spacing_mm", std::nullopt, {.min = 0.0, .max = 1000.0, .min_open = true, .to_si = kMillimetre},
                                   "distances of voxel centres along i, j, k");
  const bool turned = root.has("direction"), placed = root.has("origin_mm");
  if (!turned) image.assumed.emplace_back("no direction in the sidecar: i towards left, j towards posterior, k towards superior");
  if (!placed) image.assumed.emplace_back("no origin in the sidecar: first voxel at 0");
  const auto nine = root.numbers("direction", std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}, 9, {.min = -1.001, .max = 1.001},
                                 "unit vectors along which i, then j, then k run: left, posterior, superior");
  bool units = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 unit(nine[3 * axis], nine[3 * axis + 1], nine[3 * axis + 2]);
    image.bone_from_index.linear[axis] = unit * spacing[axis];
    if (std::abs(glm::length(unit) - 1.0) <= kUnitLength) continue;
    units = false;
    root.fault("direction", fmt::format("has a vector of length {:.4g} for {}; it must be 1", glm::length(unit), "ijk"[axis]));
  }
  const bool spaced = glm::all(glm::greaterThan(spacing, Vec3(0.0)));  // otherwise already reported
  if (const auto error = affine_error({Mat3(spacing.x, 0, 0, 0, spacing.y, 0, 0, 0, spacing.z), Vec3(0.0)}); error && spaced)
    root.fault("spacing_mm", "is not read: " + *error);
  else if (const auto flat = affine_error(image.bone_from_index); flat && units && spaced)
    root.fault("direction", "is not read: " + *flat);
  image.bone_from_index.offset =
      root.vector("origin_mm", Vec3(0.0), {.to_si = kMillimetre}, "centre of the first voxel: left, posterior, superior");
}

/// `data`, or `files` with an optional `folder`.
void read_files(TableReader& root, RawSidecar& out) {
  const bool one = root.has("data"), many = root.has("files"), folder = root.has("folder");
  out.data = root.text("data", "", "the one file of the voxels; $NAME/... by the environment");
  out.files = root.text("files", "", "pattern of one file a slice, * for its number, as CThead.*; slices are in the order of the numbers");
  out.folder = root.text("folder", ".", "folder of the files; $NAME/... by the environment");
  out.data_place = root.place_of("data"), out.files_place = root.place_of("files"), out.folder_place = root.place_of("folder");
  if (one == many) root.fault(one ? "files" : "data", one ? "and data are both present: give one of them" : "or files is required");
  if (one && out.data.empty()) root.fault("data", "names no file");
  if (one && folder) root.fault("folder", "goes with files, not with data");
  if (many && std::count(out.files.begin(), out.files.end(), '*') != 1) root.fault("files", "must have exactly one * for the number");
  if (many && out.files.find('/') != std::string::npos) root.fault("files", "must not have a folder in it: use folder");
  out.offset_bytes = static_cast<std::uint64_t>(
      root.integer("offset_bytes", 0, 0, static_cast<std::int64_t>(kMostOffset), "bytes to skip at the start of each file"));
}

/// @returns an error for a scene or the file of a tool in place of the description of a volume.
Status describes_voxels(const TomlDocument& document) {
  Issues unread;
  const TableReader root = document.root(unread);
  const std::string& file = document.file_name();
  if (root.has("dims") || root.has("type") || root.has("data") || root.has("files")) return {};
  if (root.has("region") || root.has("mesh"))
    return bad_input(fmt::format("is a tool file, not a volume: burrhole tools {} describes it", file), file);
  if (root.has("volume") || root.has("approach") || root.has("tool"))
    return bad_input(fmt::format("is a scene, not a volume: burrhole explain {0} describes it, burrhole drill {0} drills it", file), file);
  return {};
}

}  // namespace

std::vector<std::string> raw_type_names() {
  std::vector<std::string> names;
  for (const auto& [name, type] : kTypes) names.emplace_back(name);
  return names;
}

Result<RawSidecar> parse_raw_sidecar(const TomlDocument& document, KeyLog* log) {
  if (const Status valid = describes_voxels(document); !valid) return valid.error();
  Issues issues;
  TableReader root = document.root(issues, log);
  RawSidecar out;
  read_form(root, out.image.form);
  read_grid(root, out.image);
  read_files(root, out);
  const std::string quantity =
      root.choice("quantity", "unknown", {"hounsfield", "unknown"}, "what the values mean; unknown: determined from the values");
  out.quantity = quantity == "hounsfield" ? Quantity::hounsfield : Quantity::unknown;
  if (const std::string guess = root.text("assumed", "", "what in this file is an assumption; every report prints it"); !guess.empty())
    out.image.assumed.push_back(guess);
  root.finish();
  if (issues.empty()) return out;
  Error first = issues.front();
  if (issues.size() > 1) first.message += fmt::format(" (and {} more)", issues.size() - 1);
  return first;
}

}  // namespace burrhole
