/// core/voxel/vdb_header.h: the start of a .vdb file, checked before OpenVDB reads it: OpenVDB allocates what a length in the file says (up
///   to 4 GB), and prints a message about an unknown version. Voxels are not read here.
///   Units  bytes.   Source  layout of file versions 220 to 224, [OpenVDB] io/Archive.cc, io/GridDescriptor.cc, MetaMap.cc.
///   Thread  any.
#pragma once

#include <cstdint>
#include <istream>
#include <optional>
#include <string>

namespace burrhole {

inline constexpr std::uint32_t kOldestVdbVersion = 220;  ///< of OpenVDB 1.0
inline constexpr std::uint32_t kNewestVdbVersion = 224;  ///< of OpenVDB 2 and later

/// Reads the header, the metadata of the file, and of each grid the descriptor and the metadata. The start of a grid after the first is
/// known only where the file has offsets; others are not checked. Exceptions of the stream must be off.
/// @param in at the start of the file. @param size of the file.
/// @returns what is wrong, without a place; nothing if OpenVDB may read it.
[[nodiscard]] std::optional<std::string> vdb_header_fault(std::istream& in, std::uint64_t size);

}  // namespace burrhole
