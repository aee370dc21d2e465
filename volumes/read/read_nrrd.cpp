#include "volumes/read/data_parts.h"
#include "volumes/read/nrrd_header.h"
#include "volumes/read/scan.h"

namespace burrhole {

Result<ReadScan> read_nrrd(const std::string& path, const ReadOptions& options) {
  const Result<std::string> text = read_header_text(path);
  if (!text) return text.error();
  Result<NrrdHeader> header = parse_nrrd(text.value());
  if (!header) return bad_input(header.error().message, path);
  const bool attached = header->data_files.empty() && !header->numbered;
  if (attached && header->header_bytes == kMostHeaderBytes) return bad_input("its header does not end within a megabyte", path);
  ImageFile file{.place = path, .format = "NRRD", .head = std::move(header->image), .packing = header->packing};
  if (attached) {
    file.parts = {{.path = path, .offset = header->header_bytes}};
  } else {
    Result<std::vector<VoxelPart>> parts = parts_of(path, header->data_files, header->numbered, file.head.dims.z);
    if (!parts) return parts.error();
    file.parts = std::move(parts).value();
  }
  for (VoxelPart& part : file.parts) {
    const Result<std::uint64_t> offset = behind_lines(part.path, part.offset, header->line_skip);
    if (!offset) return offset.error();
    part.offset = offset.value();
    part.at_end = header->at_end;
    (file.packing == Packing::packed ? part.inner_offset : part.offset) += header->byte_skip;
  }
  return read_image(std::move(file), options);
}

}  // namespace burrhole
