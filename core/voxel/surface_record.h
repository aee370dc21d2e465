/// core/voxel/surface_record.h: the record of one voxel: distance from its centre to the 0.5 surface of bone, and the normal there.
///   Frame  normals in the axes of the bone frame.   Units  [voxel unit] in voxel edges (bone_from_index.mean_edge()).   Errors  none.
///   Thread  any.   Source  own derivation (surface_records.h).
#pragma once

#include <cstdint>

namespace burrhole {

/// [voxel edges] half width of the band. Larger distances are clamped to +-kRecordBand.
inline constexpr double kRecordBand = 3.5;

/// Storage format of a record: accuracy against memory and time.
enum class RecordPrecision : std::uint8_t {
  bits8,   ///< 4 bytes: distance in 1/32 edge, normal in 1/127
  bits16,  ///< 8 bytes: distance in 1/4096 edge, normal in 1/32767
};

/// Distance, then normal x, y, z.
struct Record8 {
  std::int8_t distance, nx, ny, nz;  ///< [steps] of kRecord8Distance and kRecord8Normal
};
struct Record16 {
  std::int16_t distance, nx, ny, nz;  ///< [steps] of kRecord16Distance and kRecord16Normal
};
static_assert(sizeof(Record8) == 4 && sizeof(Record16) == 8);
inline constexpr double kRecord8Distance = 1.0 / 32.0, kRecord16Distance = 1.0 / 4096.0;  ///< [voxel edges] a step
inline constexpr double kRecord8Normal = 1.0 / 127.0, kRecord16Normal = 1.0 / 32767.0;

}  // namespace burrhole
