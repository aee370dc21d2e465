#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/volumes/read/volume_files.h"
#include "volumes/read/pixels.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

std::vector<float> converted(const std::string& raw, const PixelForm& form) {
  std::vector<float> out(raw.size() / bytes_of(form.type));
  to_float(std::as_bytes(std::span(raw)), form, out);
  return out;
}

/// Extremes and a middle value of T, in both byte orders.
template <class T>
void check_type(PixelType type) {
  CHECK(bytes_of(type) == sizeof(T));
  for (const bool big : {false, true}) {
    std::string raw;
    const T values[] = {std::numeric_limits<T>::lowest(), T(0), T(1), T(100), std::numeric_limits<T>::max()};
    for (const T value : values) put(raw, value, big);
    const std::vector<float> got = converted(raw, {.type = type, .big_endian = big});
    for (std::size_t n = 0; n < got.size(); ++n) CHECK(got[n] == static_cast<float>(static_cast<double>(values[n])));
  }
}

}  // namespace

TEST_CASE("to_float: extremes of every type, both byte orders") {
  check_type<std::uint8_t>(PixelType::u8);
  check_type<std::int8_t>(PixelType::i8);
  check_type<std::uint16_t>(PixelType::u16);
  check_type<std::int16_t>(PixelType::i16);
  check_type<std::uint32_t>(PixelType::u32);
  check_type<std::int32_t>(PixelType::i32);
  check_type<std::uint64_t>(PixelType::u64);
  check_type<std::int64_t>(PixelType::i64);
  check_type<float>(PixelType::f32);
}

TEST_CASE("to_float: the wrong byte order gives other numbers, so the check above can fail") {
  std::string raw;
  put(raw, std::int16_t{258}, false);
  CHECK(converted(raw, {.type = PixelType::i16}) == std::vector<float>{258.0f});
  put(raw, std::int16_t{300}, false);
  CHECK(converted(raw, {.type = PixelType::i16, .big_endian = true}) != std::vector<float>{258.0f, 300.0f});
}

TEST_CASE("to_float: slope and intercept are applied in double, then rounded once") {
  std::string raw;
  put(raw, std::int32_t{16777217}, false);  // 2^24 + 1: a float has no room for it, so float arithmetic would lose the 1
  CHECK(converted(raw, {.type = PixelType::i32, .slope = 1.0, .intercept = -16777216.0}) == std::vector<float>{1.0f});
  put(raw, std::int32_t{-3}, false);
  CHECK(converted(raw, {.type = PixelType::i32, .slope = 0.5, .intercept = 2.0})[1] == 0.5f);
}

TEST_CASE("count_not_finite: NaN and both infinities are counted and kept") {
  std::string raw;
  for (const double value : {1.0, std::nan(""), HUGE_VAL, -HUGE_VAL, 0.0}) put(raw, value, false);
  const std::vector<float> got = converted(raw, {.type = PixelType::f64});
  CHECK(count_not_finite(got) == 3);
  CHECK(std::isnan(got[1]));
  CHECK(count_not_finite({}) == 0);
}
