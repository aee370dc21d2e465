#include "volumes/read/data_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "volumes/read/byte_stream.h"

namespace burrhole {

Result<std::string> read_header_text(const std::string& path) {
  const Result<std::vector<std::byte>> head = read_head(path, false, kMostHeaderBytes);
  if (!head) return head.error();
  return std::string(reinterpret_cast<const char*>(head.value().data()), head.value().size());
}

Result<std::vector<VoxelPart>> parts_of(const std::string& header_path, const std::vector<std::string>& names,
                                        const std::optional<NumberedNames>& numbered, int slices) {
  const std::uint64_t count = numbered ? numbered->count() : names.size();
  if (count == 0 || count > static_cast<std::uint64_t>(slices))
    return bad_input(fmt::format("names {} data files for {} slices", count, slices), header_path);
  const std::filesystem::path folder = std::filesystem::path(header_path).parent_path();
  std::vector<VoxelPart> parts;
  for (std::uint64_t n = 0; n < count; ++n) {
    parts.push_back({.path = (folder / (numbered ? numbered->name(n) : names[n])).string()});
    if (std::error_code ignored; !std::filesystem::is_regular_file(parts.back().path, ignored))
      return bad_input(fmt::format("data file {} of {} is missing", n + 1, count), header_path);
  }
  return parts;
}

Result<std::uint64_t> behind_lines(const std::string& path, std::uint64_t from, std::uint64_t lines) {
  if (lines == 0) return from;
  Result<ByteStream> stream = ByteStream::open(path, from, false);
  if (!stream) return stream.error();
  std::vector<std::byte> start(kMostHeaderBytes);
  const Result<std::size_t> got = stream->read(start);
  if (!got) return got.error();
  std::uint64_t seen = 0;
  for (std::size_t n = 0; n < got.value(); ++n)
    if (start[n] == std::byte{'\n'} && ++seen == lines) return from + n + 1;
  return bad_input(fmt::format("line skip: {} line ends where {} should be", seen, lines), path);
}

}  // namespace burrhole
