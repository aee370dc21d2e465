#include "volumes/read/dicom_series.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <system_error>

#include "core/base/units.h"
#include "core/config/toml_messages.h"
#include "volumes/read/raw_template.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

using ReasonCounts = std::map<std::string, std::size_t>;

std::vector<Skipped> by_frequency(const ReasonCounts& counts) {
  std::vector<Skipped> out;
  for (const auto& [reason, count] : counts) out.push_back({reason, count});
  std::stable_sort(out.begin(), out.end(), [](const Skipped& a, const Skipped& b) { return a.count > b.count; });
  return out;
}

std::string counts_text(const std::vector<Skipped>& skipped) {
  std::vector<std::string> words;
  for (const Skipped& s : skipped) words.push_back(fmt::format("{} {}", s.count, s.reason));
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Regular files below a folder, sorted. Links to folders are not followed: they can run in circles.
Result<std::vector<std::string>> files_below(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, error), end;
  while (!error && entry != end) {
    std::error_code ignored;  // a link that leads nowhere is no file
    if (entry->is_regular_file(ignored)) files.push_back(entry->path().string());
    entry.increment(error);
  }
  if (error) return bad_input("the folder cannot be read: " + error.message(), folder);
  if (files.empty()) return bad_input("the folder holds no files", folder);
  std::sort(files.begin(), files.end());
  return files;
}

Result<std::vector<std::string>> files_of(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return bad_input("there is no such file or folder", path);
  if (fs::is_directory(status)) return files_below(path);
  if (!fs::is_regular_file(status)) return bad_input("neither a file nor a folder", path);
  return std::vector<std::string>{path};
}

Error nothing_left(const std::string& path, const std::vector<std::string>& files, const std::vector<Skipped>& skipped) {
  const bool lone = files.size() == 1 && files.front() == path;
  // Headerless voxels are what such a folder most often holds.
  if (!lone)
    return bad_input(fmt::format("none of {} files is a slice of a scan: {}; {}", files.size(), counts_text(skipped), raw_template(files)),
                     path);
  const std::string& reason = skipped.front().reason;
  return bad_input(reason == "not DICOM" ? "the file is not DICOM" : fmt::format("the file is not a slice of a scan: {}", reason), path);
}

std::string direction_of(const Vec3& row, const Vec3& column) {
  const Vec3 normal = glm::abs(glm::cross(row, column));
  if (normal.z >= normal.x && normal.z >= normal.y) return "axial";
  return normal.y >= normal.x ? "coronal" : "sagittal";
}

/// An error of a single file makes the series invalid; the message states the file and the number of such files.
void note_file_errors(const DicomFolder& folder, DicomSeries& series) {
  std::size_t invalid = 0;
  for (const std::size_t n : series.files) {
    const DicomHeader& h = folder.headers[n];
    if (h.error.empty() || invalid++ > 0) continue;
    series.line.error = h.error;
    series.error_place = h.path;
  }
  if (invalid > 0 && series.files.size() > 1)
    series.line.error += fmt::format(" ({} of {} files of the series are invalid)", invalid, series.files.size());
}

/// Frames of a multi-frame file at equal positions are a time series or several stacks.
std::string repeated_frames(const std::vector<SlicePlane>& planes) {
  std::set<std::array<long long, 3>> places;  // [um]
  for (const SlicePlane& p : planes) {
    std::array<long long, 3> key{};
    for (int c = 0; c < 3; ++c) key[static_cast<std::size_t>(c)] = std::llround(std::clamp(p.position[c], -1e6, 1e6) * 1e3);
    places.insert(key);
  }
  if (places.size() == planes.size()) return {};
  return fmt::format("multi-frame image that is not a volume: {} frames at {} positions", planes.size(), places.size());
}

/// Positions of all slices, or the error of the series.
std::vector<SlicePlane> planes_of(const DicomFolder& folder, DicomSeries& series) {
  std::vector<SlicePlane> planes;
  std::size_t without = 0;
  bool multi_frame = false;
  for (const SliceSource& s : series.slices) {
    const DicomHeader& h = folder.headers[s.file];
    const DicomFrame& frame = h.frames[s.frame];
    multi_frame = multi_frame || h.frames.size() > 1;
    if (frame.plane)
      planes.push_back(*frame.plane);
    else
      ++without;
  }
  if (without > 0 && multi_frame)
    series.line.error =
        fmt::format("multi-frame image that is not a volume: {} of {} frames without a position, orientation or pixel spacing", without,
                    series.slices.size());
  else if (without > 0)
    series.line.error = fmt::format("{} of {} slices lack position, orientation or pixel spacing", without, series.slices.size());
  else if (multi_frame)
    series.line.error = repeated_frames(planes);
  return planes;
}

/// Lists the stack of slices of one series, and its error if they are none.
void stack_series(const DicomFolder& folder, DicomSeries& series) {
  const DicomHeader& first = folder.headers[series.files.front()];
  series.line.modality = first.modality;
  // An invalid file may have no frames.
  const std::size_t slices = series.is_half ? series.slices.size() : std::max(series.slices.size(), series.files.size());
  series.line.dims = Vec3i(first.columns, first.rows, static_cast<int>(slices));
  if (!first.frames.empty() && first.frames.front().plane) {
    const SlicePlane& plane = *first.frames.front().plane;
    series.line.direction = direction_of(plane.row, plane.column);
    series.line.spacing = Vec3(plane.column_spacing, plane.row_spacing, first.frames.front().thickness_mm) * 1e-3;
  }
  note_file_errors(folder, series);
  if (!series.line.error.empty()) return;

  const std::vector<SlicePlane> planes = planes_of(folder, series);
  if (!series.line.error.empty()) return;
  const double thickness = first.frames.front().thickness_mm;
  auto stack = stack_slices(planes, thickness);
  if (!stack) {
    series.line.error = stack.error().message;
    return;
  }
  series.thickness_assumed = planes.size() == 1;
  series.stack = std::move(stack).value();
  series.line.spacing = describe_grid(series.stack.bone_from_index).spacing;
  std::vector<SliceSource> sorted;
  for (const std::size_t n : series.stack.order) sorted.push_back(series.slices[n]);
  series.slices = std::move(sorted);
  if (series.voxel_count() > kMaxScanVoxels)
    series.line.error = fmt::format("{:.4g} voxels are more than the {:.4g} that are read", series.voxel_count(), kMaxScanVoxels);
}

/// Slices of a series in two halves.
using Halves = std::array<std::vector<SliceSource>, 2>;

/// Two slices at each place, which one number of their headers separates: all of one half are below all of the other.
std::optional<Halves> alternate(const DicomFolder& folder, const std::vector<SliceSource>& slices, const std::vector<SlicePlane>& planes,
                                const std::vector<std::size_t>& order) {
  constexpr double kSamePlace = 1e-3;  // [mm] as in stack_slices()
  if (order.size() % 2 != 0) return std::nullopt;
  for (std::size_t n = 0; n < order.size(); n += 2)
    if (glm::length(planes[order[n]].position - planes[order[n + 1]].position) > kSamePlace) return std::nullopt;
  for (const auto number : {&DicomHeader::acquisition_number, &DicomHeader::instance_number}) {
    Halves out;
    double highest = -std::numeric_limits<double>::infinity(), lowest = -highest;  // of the first half, of the second
    for (std::size_t n = 0; n < order.size(); n += 2) {
      const SliceSource &a = slices[order[n]], &b = slices[order[n + 1]];
      constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
      const double of_a = (folder.headers[a.file].*number).value_or(kNone), of_b = (folder.headers[b.file].*number).value_or(kNone);
      out[0].push_back(of_a < of_b ? a : b);
      out[1].push_back(of_a < of_b ? b : a);
      highest = of_a == of_a && of_b == of_b ? std::max(highest, std::min(of_a, of_b)) : std::numeric_limits<double>::infinity();
      lowest = std::min(lowest, std::max(of_a, of_b));
    }
    if (highest < lowest) return out;
  }
  return std::nullopt;
}

/// Two distances between slices: the longest even stack from one end, and the rest, to which the last slice of the first may belong. Two stacks
/// of one distance are a stack with a gap.
std::optional<Halves> divide(const std::vector<SliceSource>& slices, const std::vector<SlicePlane>& planes,
                             const std::vector<std::size_t>& order) {
  constexpr std::size_t kLeast = 3;    // slices of a half: two show no distance that repeats
  constexpr double kOtherStep = 0.02;  // [-]
  const auto step = [&](std::size_t n) { return glm::length(planes[order[n + 1]].position - planes[order[n]].position); };
  const auto is_even = [&](std::size_t from, std::size_t to) {
    std::vector<SlicePlane> part;
    for (std::size_t n = from; n < to; ++n) part.push_back(planes[order[n]]);
    return part.size() >= kLeast && stack_slices(part, 0.0).ok();
  };
  std::size_t end = 1;  // of the first half
  while (end < order.size() && std::abs(step(end - 1) - step(0)) <= kOtherStep * step(0)) ++end;
  if (end == order.size() || !is_even(0, end)) return std::nullopt;
  for (const std::size_t begin : {end - 1, end}) {
    if (begin + 1 >= order.size() || std::abs(step(begin) - step(0)) <= kOtherStep * step(0) || !is_even(begin, order.size())) continue;
    Halves out;
    for (std::size_t n = 0; n < end; ++n) out[0].push_back(slices[order[n]]);
    for (std::size_t n = begin; n < order.size(); ++n) out[1].push_back(slices[order[n]]);
    return out;
  }
  return std::nullopt;
}

/// Two even stacks in a series that is none, and in the error of the series that they are there; nothing if there are none.
std::vector<DicomSeries> halves_of(const DicomFolder& folder, DicomSeries& series) {
  std::vector<SlicePlane> planes;
  for (const SliceSource& s : series.slices) {
    const auto& plane = folder.headers[s.file].frames[s.frame].plane;
    if (!plane) return {};
    planes.push_back(*plane);
  }
  if (planes.size() < 2) return {};
  const Vec3 normal = glm::cross(planes.front().row, planes.front().column);
  std::vector<std::size_t> order(planes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t n) { return glm::dot(planes[n].position, normal); });
  auto halves = alternate(folder, series.slices, planes, order);
  if (!halves) halves = divide(series.slices, planes, order);
  if (!halves) return {};
  std::vector<DicomSeries> out;
  for (std::size_t n = 0; n < 2; ++n) {
    DicomSeries half;
    half.is_half = true;
    half.line.name = fmt::format("{}:{}", series.line.name, n + 1);
    half.slices = (*halves)[n];
    for (const SliceSource& s : half.slices) half.files.push_back(s.file);
    std::ranges::sort(half.files);
    half.files.erase(std::ranges::unique(half.files).begin(), half.files.end());
    stack_series(folder, half);
    if (!half.line.error.empty()) return {};
    out.push_back(std::move(half));
  }
  const auto text = [](const DicomSeries& s) {
    return fmt::format("{} of {} slices {:.4g} mm apart", s.line.name, s.line.dims.z, s.line.spacing.z / kMillimetre);
  };
  series.line.error = fmt::format("{}; it is two even stacks, name one of them (--series; series in a scene): {}, {}", series.line.error,
                                  text(out[0]), text(out[1]));
  return out;
}

/// "3", then "3b", "3c", ... for further series of that number.
std::string series_name(const std::string& number, std::size_t nth) {
  if (nth == 0) return number;
  return nth < 26 ? number + static_cast<char>('a' + nth) : fmt::format("{}.{}", number, nth + 1);
}

/// Order: halves last; without errors first, then CT, then axial, then larger.
bool better(const DicomSeries& a, const DicomSeries& b) {
  const auto rank = [](const DicomSeries& s) {
    return std::make_tuple(!s.is_half, s.line.error.empty(), s.line.modality == "CT", s.line.direction == "axial", s.voxel_count());
  };
  return rank(a) > rank(b);
}

/// Whether two files with one instance UID are the same slice of the same series.
bool lies_where(const DicomHeader& a, const DicomHeader& b) {
  if (a.series_uid != b.series_uid || a.frames.size() != b.frames.size()) return false;
  for (std::size_t n = 0; n < a.frames.size(); ++n) {
    const auto &p = a.frames[n].plane, &q = b.frames[n].plane;
    if (p.has_value() != q.has_value() || (p && p->position != q->position)) return false;
  }
  return true;
}

}  // namespace

Result<DicomFolder> scan_dicom_folder(const std::string& folder_or_file, const std::vector<DicomKeepTag>& keep,
                                      const std::function<Status()>& goes_on) {
  const auto files = files_of(folder_or_file);
  if (!files) return files.error();
  DicomFolder out;
  ReasonCounts skipped;
  std::map<std::string, std::size_t> instances;  // to the header that has the UID
  for (const std::string& path : *files) {
    if (Status on = goes_on(); !on) return on.error();
    auto header = read_dicom_header(path, keep);
    if (!header) return header.error();
    std::string reason = header->skip;
    if (reason.empty() && !header->instance_uid.empty()) {
      const auto [at, fresh] = instances.try_emplace(header->instance_uid, out.headers.size());
      // One UID on slices at different positions is an error of anonymisation: these are not copies.
      if (!fresh && lies_where(out.headers[at->second], *header)) reason = "duplicate";
    }
    if (reason.empty())
      out.headers.push_back(std::move(header).value());
    else
      ++skipped[reason];
  }
  out.skipped = by_frequency(skipped);
  if (out.headers.empty()) return nothing_left(folder_or_file, *files, out.skipped);
  return out;
}

std::vector<DicomSeries> group_series(const DicomFolder& folder) {
  std::vector<DicomSeries> series;
  std::map<std::string, std::size_t> of_uid, of_number;
  for (std::size_t n = 0; n < folder.headers.size(); ++n) {
    const DicomHeader& h = folder.headers[n];
    const auto [at, fresh] = of_uid.try_emplace(h.series_uid, series.size());
    if (fresh) series.emplace_back().line.name = series_name(h.series_number, of_number[h.series_number]++);
    series[at->second].files.push_back(n);
  }
  std::vector<DicomSeries> out;
  for (DicomSeries& s : series) {
    for (const std::size_t n : s.files)
      for (std::size_t f = 0; f < folder.headers[n].frames.size(); ++f) s.slices.push_back({n, f});
    stack_series(folder, s);
    std::vector<DicomSeries> halves;
    if (!s.line.error.empty() && s.error_place.empty()) halves = halves_of(folder, s);
    out.push_back(std::move(s));
    std::ranges::move(halves, std::back_inserter(out));
  }
  return out;
}

Result<std::size_t> choose_series(const std::vector<DicomSeries>& series, const std::string& name, const std::string& place) {
  std::vector<std::string> names;
  for (const DicomSeries& s : series) names.push_back(s.line.name);
  auto chosen = std::min_element(series.begin(), series.end(), better);
  if (!name.empty()) {
    chosen = std::find_if(series.begin(), series.end(), [&](const DicomSeries& s) { return s.line.name == name; });
    if (chosen == series.end())
      return bad_input(fmt::format("no series '{}'; there are: {}", one_line(name), fmt::join(names, ", ")), place);
  }
  if (name.empty() && series.size() > 1 && chosen->line.error.empty() && chosen->slices.size() == 1)
    return bad_input(fmt::format("the best of {} series, {}, has one slice; name the series to read (--series; series in a scene): {}",
                                 series.size(), chosen->line.name, fmt::join(names, ", ")),
                     place);
  if (chosen->line.error.empty()) return static_cast<std::size_t>(chosen - series.begin());
  const bool alone = std::ranges::count(series, false, &DicomSeries::is_half) == 1;
  const std::string which = alone ? "" : fmt::format("series {}: ", chosen->line.name);
  return bad_input(which + chosen->line.error, chosen->error_place.empty() ? place : chosen->error_place);
}

}  // namespace burrhole
