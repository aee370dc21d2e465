/// volumes/read/pixels.h: converts raw voxel bytes to floats: byte order, slope and intercept in one pass.
///   Units  of the values in the file.   Errors  none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace burrhole {

enum class PixelType : std::uint8_t { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

[[nodiscard]] std::size_t bytes_of(PixelType type) noexcept;

struct PixelForm {
  PixelType type = PixelType::i16;
  bool big_endian = false;
  double slope = 1.0;      ///< [unit of the values per stored unit]
  double intercept = 0.0;  ///< [unit of the values]
};

/// out[n] = float(slope * raw[n] + intercept), computed in double. @pre raw.size() == out.size() * bytes_of(form.type).
void to_float(std::span<const std::byte> raw, const PixelForm& form, std::span<float> out) noexcept;

/// Number of NaN and infinite values.
[[nodiscard]] std::size_t count_not_finite(std::span<const float> values) noexcept;

}  // namespace burrhole
