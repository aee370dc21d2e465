/// volumes/read/data_parts.h: resolves the file names in a text header to parts on disk, for NRRD and MetaImage.
///   Errors  bad_input.   Thread  any.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "volumes/read/image_file.h"
#include "volumes/read/number_text.h"

namespace burrhole {

inline constexpr std::size_t kMostHeaderBytes = 1048576;  ///< limit of the text of a header

/// @returns the start of a file as text, at most kMostHeaderBytes.
[[nodiscard]] Result<std::string> read_header_text(const std::string& path);

/// @returns one part per data file, in order. @param names of the files; not used if `numbered` is given. @param numbered a rule that
/// generates the names (slice001.raw, slice002.raw, ...). @param slices of the volume. Names are relative to the folder of `header_path`.
/// bad_input if there is no name, if there are more names than slices, or if a file does not exist.
[[nodiscard]] Result<std::vector<VoxelPart>> parts_of(const std::string& header_path, const std::vector<std::string>& names,
                                                      const std::optional<NumberedNames>& numbered, int slices);

/// @returns the offset [bytes] after `lines` line ends that follow byte `from`; bad_input if there are fewer within kMostHeaderBytes.
[[nodiscard]] Result<std::uint64_t> behind_lines(const std::string& path, std::uint64_t from, std::uint64_t lines);

}  // namespace burrhole
