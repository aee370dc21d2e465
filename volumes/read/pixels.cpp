#include "volumes/read/pixels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/base/assert.h"

namespace burrhole {
namespace {

template <class T>
T load(const std::byte* at, bool swapped) noexcept {
  std::byte bytes[sizeof(T)];
  std::memcpy(bytes, at, sizeof(T));
  if (swapped) std::reverse(bytes, bytes + sizeof(T));
  return std::bit_cast<T>(bytes);
}

template <class T>
void convert(std::span<const std::byte> raw, const PixelForm& form, std::span<float> out) noexcept {
  const bool swapped = form.big_endian != (std::endian::native == std::endian::big);
  for (std::size_t n = 0; n < out.size(); ++n)
    out[n] = static_cast<float>(form.slope * static_cast<double>(load<T>(raw.data() + n * sizeof(T), swapped)) + form.intercept);
}

}  // namespace

std::size_t bytes_of(PixelType type) noexcept {
  switch (type) {
    case PixelType::u8:
    case PixelType::i8:
      return 1;
    case PixelType::u16:
    case PixelType::i16:
      return 2;
    case PixelType::u32:
    case PixelType::i32:
    case PixelType::f32:
      return 4;
    case PixelType::u64:
    case PixelType::i64:
    case PixelType::f64:
      return 8;
  }
  return 0;
}

void to_float(std::span<const std::byte> raw, const PixelForm& form, std::span<float> out) noexcept {
  BH_ASSERT(raw.size() == out.size() * bytes_of(form.type));
  switch (form.type) {
    case PixelType::u8:
      return convert<std::uint8_t>(raw, form, out);
    case PixelType::i8:
      return convert<std::int8_t>(raw, form, out);
    case PixelType::u16:
      return convert<std::uint16_t>(raw, form, out);
    case PixelType::i16:
      return convert<std::int16_t>(raw, form, out);
    case PixelType::u32:
      return convert<std::uint32_t>(raw, form, out);
    case PixelType::i32:
      return convert<std::int32_t>(raw, form, out);
    case PixelType::u64:
      return convert<std::uint64_t>(raw, form, out);
    case PixelType::i64:
      return convert<std::int64_t>(raw, form, out);
    case PixelType::f32:
      return convert<float>(raw, form, out);
    case PixelType::f64:
      return convert<double>(raw, form, out);
  }
}

std::size_t count_not_finite(std::span<const float> values) noexcept {
  return static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [](float value) { return !std::isfinite(value); }));
}

}  // namespace burrhole
