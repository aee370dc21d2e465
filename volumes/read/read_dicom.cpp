// read_dicom: converts a folder or file of DICOM to a Scan and its report.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>

#include "core/base/units.h"
#include "volumes/read/dicom_pixels.h"
#include "volumes/read/dicom_series.h"
#include "volumes/read/gdcm_codecs.h"
#include "volumes/read/memory_check.h"
#include "volumes/read/scan.h"

namespace burrhole {
namespace {

constexpr double kReportedTilt = 0.05 * kDegree;

Result<std::vector<DicomKeepTag>> keep_tags(const std::vector<std::string>& keywords) {
  std::vector<DicomKeepTag> out;
  for (const std::string& keyword : keywords) {
    auto found = find_keyword(keyword);
    if (!found) return found.error();
    out.push_back(std::move(found).value());
  }
  return out;
}

Quantity quantity_of(const DicomFolder& folder, const DicomSeries& series) {
  if (series.line.modality != "CT") return Quantity::other;
  const bool hounsfield =
      std::all_of(series.files.begin(), series.files.end(), [&](std::size_t n) { return folder.headers[n].hounsfield; });
  return hounsfield ? Quantity::hounsfield : Quantity::other;
}

/// Larger series that were not selected because of errors or direction.
void report_larger_series(const std::vector<DicomSeries>& series, std::size_t taken, std::vector<std::string>& assumed) {
  for (const DicomSeries& s : series) {
    if (s.is_half || s.voxel_count() <= series[taken].voxel_count()) continue;
    const std::string times = fmt::format("series {} is {:.1f} times as large as series {}, which was taken,", s.line.name,
                                          s.voxel_count() / series[taken].voxel_count(), series[taken].line.name);
    if (!s.line.error.empty())
      assumed.push_back(fmt::format("{} but cannot be read: {}", times, s.line.error));
    else
      assumed.push_back(fmt::format("{} but is {}", times, s.line.direction));
  }
}

std::size_t count_files(const DicomFolder& folder, const DicomSeries& series, bool DicomHeader::*property, bool value) {
  return static_cast<std::size_t>(
      std::count_if(series.files.begin(), series.files.end(), [&](std::size_t n) { return folder.headers[n].*property == value; }));
}

void report_assumptions(const DicomFolder& folder, const DicomSeries& series, Quantity quantity, std::vector<std::string>& assumed) {
  const double tilt = series.stack.tilt;
  if (series.thickness_assumed)
    assumed.push_back(fmt::format("one slice: thickness {:.4g} mm from SliceThickness", series.line.spacing.z / kMillimetre));
  if (tilt > kReportedTilt)
    assumed.push_back(fmt::format("slices are tilted by {:.2f} degrees (gantry tilt), kept as shear", tilt / kDegree));
  if (quantity == Quantity::other && series.line.modality == "CT") assumed.push_back("RescaleType is not HU");
  if (const std::size_t n = count_files(folder, series, &DicomHeader::has_rescale, false); n > 0 && quantity == Quantity::hounsfield)
    assumed.push_back(fmt::format("{} of {} files lack rescale slope or intercept: 1 and 0 are taken", n, series.files.size()));
  // MONOCHROME1 inverts the display, not the values: HU follow from slope and intercept. PS3.3 C.7.6.3.1.2, C.11.1.
  if (const std::size_t n = count_files(folder, series, &DicomHeader::white_is_low, true); n > 0)
    assumed.push_back(
        fmt::format("{} of {} files are MONOCHROME1, which concerns display alone: values as stored", n, series.files.size()));
  if (const std::size_t n = count_files(folder, series, &DicomHeader::lossy, true); n > 0)
    assumed.push_back(fmt::format("{} of {} files were compressed with loss", n, series.files.size()));
}

void report_counts(const PixelCounts& counts, std::vector<std::string>& assumed) {
  if (counts.padded > 0) assumed.push_back(fmt::format("{} padding pixels set to -1024 HU (air)", counts.padded));
  if (counts.clamped > 0) assumed.push_back(fmt::format("{} pixels below -1024 HU set to -1024 HU", counts.clamped));
}

/// Slice by slice in stack order. A multi-frame file stays open while its frames are consecutive.
Status read_pixels(const DicomFolder& folder, const DicomSeries& series, const ReadOptions& options, Scan& scan, PixelCounts& counts) {
  const std::size_t each = static_cast<std::size_t>(scan.dims.x) * static_cast<std::size_t>(scan.dims.y);
  if (const auto error = memory_error(series.voxel_count() * sizeof(float), options.memory))
    return Error{ErrorCode::unavailable, *error, {}};
  scan.values.resize(each * series.slices.size());
  std::optional<FrameReader> reader;
  std::size_t open_file = 0;
  for (std::size_t k = 0; k < series.slices.size(); ++k) {
    const SliceSource source = series.slices[k];
    if (!reader || open_file != source.file) {
      reader.reset();
      auto opened = FrameReader::open(folder.headers[source.file]);
      if (!opened) return opened.error();
      reader.emplace(std::move(opened).value());
      open_file = source.file;
    }
    const std::span<float> out = std::span(scan.values).subspan(k * each, each);
    if (Status status = reader->read(source.frame, scan.quantity == Quantity::hounsfield, out, counts); !status) return status;
    if (Status on = advance(options, static_cast<double>(k + 1) / static_cast<double>(series.slices.size())); !on) return on;
  }
  return {};
}

Result<ReadScan> read_checked(const std::string& path, const ReadOptions& options) {
  const auto keep = keep_tags(options.keep);
  if (!keep) return keep.error();
  ReadOptions headers;  // a share of the headers is none of the reading: they are not reported
  headers.stop = options.stop;
  const auto folder = scan_dicom_folder(path, *keep, [&] { return advance(headers, 0.0); });
  if (!folder) return folder.error();
  std::vector<DicomSeries> series = group_series(*folder);
  const auto chosen = choose_series(series, options.series, path);
  if (!chosen) return chosen.error();
  DicomSeries& taken = series[*chosen];
  taken.line.taken = true;

  ReadScan out;
  out.scan.dims = taken.line.dims;
  out.scan.bone_from_index = taken.stack.bone_from_index;
  out.scan.quantity = quantity_of(*folder, taken);
  if (options.accept)
    if (Status accepted = options.accept(out.scan); !accepted) return accepted.error();
  PixelCounts counts;
  if (Status status = read_pixels(*folder, taken, options, out.scan, counts); !status) return status.error();

  out.report.format = "DICOM";
  out.report.skipped = folder->skipped;
  if (options.series.empty()) report_larger_series(series, *chosen, out.report.assumed);
  report_assumptions(*folder, taken, out.scan.quantity, out.report.assumed);
  report_counts(counts, out.report.assumed);
  const DicomHeader& first = folder->headers[taken.slices.front().file];
  for (std::size_t n = 0; n < keep->size(); ++n) out.report.kept.push_back({(*keep)[n].keyword, first.kept[n]});
  for (DicomSeries& s : series) out.report.series.push_back(std::move(s.line));
  return out;
}

}  // namespace

Result<ReadScan> read_dicom(const std::string& folder_or_file, const ReadOptions& options) {
  try {
    return read_checked(folder_or_file, options);
  } catch (const std::bad_alloc&) {
    return bad_input("the scan does not fit into memory", folder_or_file);
  } catch (const std::exception&) {
    return bad_input("the scan cannot be read", folder_or_file);
  }
}

}  // namespace burrhole
