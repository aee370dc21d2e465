#include "volumes/read/data_parts.h"
#include "volumes/read/meta_header.h"
#include "volumes/read/scan.h"

namespace burrhole {

Result<ReadScan> read_metaimage(const std::string& path, const ReadOptions& options) {
  const Result<std::string> text = read_header_text(path);
  if (!text) return text.error();
  Result<MetaHeader> header = parse_metaimage(text.value());
  if (!header) return bad_input(header.error().message, path);
  ImageFile file{
      .place = path, .format = "MetaImage", .head = std::move(header->image), .quantity = header->quantity, .packing = header->packing};
  if (header->data_files.empty() && !header->numbered) {
    file.parts = {{.path = path, .offset = header->header_bytes}};
  } else {
    Result<std::vector<VoxelPart>> parts = parts_of(path, header->data_files, header->numbered, file.head.dims.z);
    if (!parts) return parts.error();
    file.parts = std::move(parts).value();
    for (VoxelPart& part : file.parts) part.offset = header->file_header_bytes;
  }
  for (VoxelPart& part : file.parts) part.at_end = header->at_end;
  return read_image(std::move(file), options);
}

}  // namespace burrhole
