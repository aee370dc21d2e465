#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "volumes/read/number_text.h"
#include "volumes/read/raw_sidecar.h"
#include "volumes/read/scan.h"
#include "volumes/read/written_path.h"

namespace burrhole {
namespace {

constexpr std::size_t kMostDigits = 9;  ///< digits of the number in a file name

struct Numbered {
  std::int64_t number = 0;
  std::string path;
};

/// The files of a folder that match the pattern, where * stands for digits only, in numeric order.
Result<std::vector<Numbered>> files_of(const std::filesystem::path& folder, const RawSidecar& sidecar) {
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  if (error) return bad_input(fmt::format("the folder {} cannot be read", folder.string()), sidecar.folder_place);
  const std::size_t star = sidecar.files.find('*');
  const std::string before = sidecar.files.substr(0, star), after = sidecar.files.substr(star + 1);
  std::vector<Numbered> found;
  for (; entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) continue;
    const std::string digits = name.substr(before.size(), name.size() - before.size() - after.size());
    const bool all = std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!all || digits.size() > kMostDigits) continue;
    found.push_back({.number = *whole_of(digits), .path = entry->path().string()});
  }
  if (error) return bad_input(fmt::format("the folder {} cannot be read to its end", folder.string()), sidecar.folder_place);
  std::sort(found.begin(), found.end(), [](const Numbered& a, const Numbered& b) { return a.number < b.number; });
  return found;
}

/// One file per slice, numbers evenly spaced: a gap would misplace all later slices.
Result<std::vector<VoxelPart>> slices_of(const std::filesystem::path& folder, const RawSidecar& sidecar) {
  const Result<std::vector<Numbered>> files = files_of(folder, sidecar);
  if (!files) return files.error();
  const std::vector<Numbered>& found = files.value();
  const std::size_t slices = static_cast<std::size_t>(sidecar.image.dims.z);
  for (std::size_t n = 1; n < found.size(); ++n) {
    if (found[n].number == found[n - 1].number)
      return bad_input(fmt::format("two files have the number {}", found[n].number), sidecar.files_place);
    if (found[n].number - found[n - 1].number != found[1].number - found[0].number)
      return bad_input(fmt::format("numbers go from {} to {}: a slice is missing", found[n - 1].number, found[n].number),
                       sidecar.files_place);
  }
  if (found.size() != slices)
    return bad_input(fmt::format("{} files fit {}, dims say {} slices", found.size(), sidecar.files, slices), sidecar.files_place);
  std::vector<VoxelPart> parts;
  parts.reserve(found.size());
  for (const Numbered& file : found) parts.push_back({.path = file.path, .offset = sidecar.offset_bytes});
  return parts;
}

}  // namespace

Result<ReadScan> read_raw(const std::string& sidecar_toml, const ReadOptions& options) {
  const Result<TomlDocument> document = TomlDocument::load(sidecar_toml);
  if (!document) return document.error();
  Result<RawSidecar> sidecar = parse_raw_sidecar(document.value());
  if (!sidecar) return sidecar.error();
  const bool one = !sidecar->data.empty();
  const auto where = one ? written_path(sidecar->data, sidecar_toml, sidecar->data_place)
                         : written_path(sidecar->folder, sidecar_toml, sidecar->folder_place);
  if (!where) return where.error();
  ImageFile file{.place = sidecar_toml, .format = "raw", .quantity = sidecar->quantity, .exact = true};
  if (one) {
    file.parts = {{.path = where.value(), .offset = sidecar->offset_bytes}};
  } else {
    Result<std::vector<VoxelPart>> slices = slices_of(where.value(), sidecar.value());
    if (!slices) {
      std::error_code ignored;
      const bool missing = !std::filesystem::exists(where.value(), ignored);
      return Error{slices.error().code, slices.error().message + (missing ? missing_data_note(sidecar->folder) : ""), slices.error().place};
    }
    file.parts = std::move(slices).value();
  }
  file.head = std::move(sidecar->image);
  return read_image(std::move(file), options);
}

}  // namespace burrhole
