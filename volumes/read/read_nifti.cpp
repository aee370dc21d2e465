#include <fmt/format.h>

#include <filesystem>

#include "volumes/read/byte_stream.h"
#include "volumes/read/nifti_header.h"
#include "volumes/read/number_text.h"
#include "volumes/read/scan.h"

namespace burrhole {
namespace {

/// Path without ".gz" and its last extension, which is returned in `ending` in lower case.
std::string stem_of(std::string path, std::string& ending) {
  if (lower(path).ends_with(".gz")) path.resize(path.size() - 3);
  ending = lower(std::filesystem::path(path).extension().string());
  path.resize(path.size() - ending.size());
  return path;
}

/// The other file of a pair: the same name with one of the extensions, packed or not, in lower or upper case.
Result<std::string> partner(const std::string& path, const std::string& stem, const std::vector<std::string>& endings) {
  for (const std::string& ending : endings)
    for (const char* const packed : {"", ".gz"})
      if (std::error_code ignored; std::filesystem::is_regular_file(stem + ending + packed, ignored)) return stem + ending + packed;
  return bad_input(fmt::format("its {} file is not beside it", endings.front()), path);
}

}  // namespace

Result<ReadScan> read_nifti(const std::string& path, const ReadOptions& options) {
  std::string ending;
  const std::string stem = stem_of(path, ending);
  std::string header_path = path;
  if (ending == ".img") {
    const Result<std::string> found = partner(path, stem, {".hdr", ".HDR"});
    if (!found) return found.error();
    header_path = found.value();
  }
  const Result<std::vector<std::byte>> head = read_head(header_path, starts_as_gzip(header_path), kNiftiHeaderBytes);
  if (!head) return head.error();
  Result<NiftiHeader> header = parse_nifti(head.value());
  if (!header) return bad_input(header.error().message, header_path);
  std::string data_path = header_path;
  if (header->pair) {
    const Result<std::string> found = ending == ".img" ? Result<std::string>(path) : partner(path, stem, {".img", ".IMG"});
    if (!found) return found.error();
    data_path = found.value();
  }
  const bool packed = starts_as_gzip(data_path);
  ImageFile file{
      .place = header_path,
      .format = header->version == 1 ? "NIfTI-1" : "NIfTI-2",
      .head = std::move(header->image),
      .packing = packed ? Packing::packed : Packing::raw,
      .parts = {{.path = data_path, .offset = packed ? 0 : header->data_offset, .inner_offset = packed ? header->data_offset : 0}}};
  return read_image(std::move(file), options);
}

}  // namespace burrhole
