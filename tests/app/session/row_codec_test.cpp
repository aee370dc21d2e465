// Blocks of rows come back bit for bit, whatever the values; a damaged block is an error, never a crash or other values.
#include "app/session/row_codec.h"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "haptics/servo/realtime.h"

namespace burrhole {
namespace {

/// Draws of one property, by number.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : seed_(mix64(seed)) {}
  std::uint64_t bits() { return mix64(seed_ ^ counter_++); }
  std::size_t below(std::size_t limit) { return static_cast<std::size_t>(bits() % limit); }

 private:
  std::uint64_t seed_, counter_ = 0;
};

/// A column as a session may hold: its kind by number.
std::vector<double> column_of_kind(std::size_t kind, std::size_t rows, Draws& draws) {
  constexpr double kSpecial[] = {0.0,
                                 -0.0,
                                 1.0,
                                 std::numeric_limits<double>::denorm_min(),
                                 -std::numeric_limits<double>::denorm_min(),
                                 std::numeric_limits<double>::min(),
                                 std::numeric_limits<double>::max(),
                                 -std::numeric_limits<double>::max(),
                                 std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::quiet_NaN(),
                                 9007199254740992.0,
                                 -9007199254740993.0,
                                 9.3e18};
  std::vector<double> out;
  double walk = 0.1, counter = static_cast<double>(draws.below(1000));
  for (std::size_t n = 0; n < rows; ++n) {
    walk += 1e-5 * std::sin(0.01 * static_cast<double>(n)) + 1e-9 * static_cast<double>(draws.below(1000));
    counter += draws.below(50) == 0 ? static_cast<double>(draws.below(1u << 30)) - 5e8 : 1.0;
    switch (kind) {
      case 0:  // any bits: NaN with payloads, denormals, both infinities
        out.push_back(std::bit_cast<double>(draws.bits()));
        break;
      case 1:  // a smooth motion with noise
        out.push_back(walk);
        break;
      case 2:  // a counter that jumps, in both directions
        out.push_back(counter);
        break;
      case 3:
        out.push_back(kSpecial[draws.below(std::size(kSpecial))]);
        break;
      case 4:  // integers, up to the largest that are exact
        out.push_back(static_cast<double>(static_cast<std::int64_t>(draws.bits()) >> draws.below(64)));
        break;
      case 5:  // a counter with one -0.0 or denormal among its values
        out.push_back(n == rows / 2 ? kSpecial[1 + 2 * draws.below(2)] : counter);
        break;
      default:  // quiet NaN with a payload, constant
        out.push_back(std::bit_cast<double>(0x7ff8000000abcdefull));
    }
  }
  return out;
}
constexpr std::size_t kKinds = 7;

struct Block {
  std::vector<SessionColumn> columns;
  std::vector<double> values;  // row after row
  std::int64_t rows = 0, every = 1;
};

Block any_block(std::uint64_t seed, std::size_t most_rows) {
  Draws draws(seed);
  Block out;
  const std::size_t rows = 1 + draws.below(most_rows), width = 1 + draws.below(8);
  out.rows = static_cast<std::int64_t>(rows);
  out.every = static_cast<std::int64_t>(1 + draws.below(6));
  out.values.resize(rows * width);
  for (std::size_t c = 0; c < width; ++c) {
    out.columns.push_back({"c", "", draws.below(3) == 0 ? Keep::coarse : Keep::exact});
    const std::vector<double> column = column_of_kind(draws.below(kKinds), rows, draws);
    for (std::size_t n = 0; n < rows; ++n) out.values[n * width + c] = column[n];
  }
  return out;
}

std::string encoded(const Block& block) { return encode_rows(block.values, block.columns, block.every); }

/// The value that a reader is to see, from the definition of `coarse`.
double expected(const Block& block, std::size_t row, std::size_t c) {
  const std::size_t width = block.columns.size(), every = static_cast<std::size_t>(block.every);
  if (block.columns[c].keep == Keep::exact) return block.values[row * width + c];
  const double kept = block.values[(row - row % every) * width + c];
  if (std::abs(kept) > static_cast<double>(std::numeric_limits<float>::max())) return std::copysign(HUGE_VAL, kept);
  return static_cast<double>(static_cast<float>(kept));
}

std::size_t wrong_values(const Block& block, const std::vector<double>& decoded) {
  REQUIRE(decoded.size() == block.values.size());
  std::size_t wrong = 0;
  for (std::size_t n = 0; n < decoded.size(); ++n) {
    const double value = expected(block, n / block.columns.size(), n % block.columns.size());
    wrong += std::bit_cast<std::uint64_t>(value) != std::bit_cast<std::uint64_t>(decoded[n]);
  }
  return wrong;
}

TEST_CASE("row codec: exact columns come back in every bit, coarse ones as floats of every Nth row") {
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    CAPTURE(seed);
    const Block block = any_block(seed, seed % 10 == 0 ? 3000 : 60);
    const auto decoded = decode_rows(encoded(block), block.columns, block.rows);
    REQUIRE_MESSAGE(decoded.ok(), (decoded ? "" : decoded.error().text()));
    CHECK(wrong_values(block, *decoded) == 0);
  }
}

TEST_CASE("row codec: exact columns come back in every bit where the processor flushes denormals") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    Block block = any_block(seed, 60);
    for (SessionColumn& column : block.columns) column.keep = Keep::exact;
    const auto decoded = [&] {
      const FlushToZero guard;
      return decode_rows(encoded(block), block.columns, block.rows);
    }();
    REQUIRE(decoded.ok());
    CHECK(wrong_values(block, *decoded) == 0);
  }
}

TEST_CASE("row codec: a damaged block is an error, or what was damaged holds no value") {
  std::size_t refused = 0, tried = 0;
  const auto try_block = [&](const Block& block, const std::string& bytes, std::int64_t rows) {
    const auto decoded = decode_rows(bytes, block.columns, rows);
    ++tried;
    if (decoded) {
      CHECK(wrong_values(block, *decoded) == 0);
      return;
    }
    ++refused;
    CHECK(decoded.error().code == ErrorCode::bad_input);
  };
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    const Block block = any_block(seed, 40);
    const std::string whole = encoded(block);
    Draws draws(seed + 1000);
    for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 40) {
      CHECK_FALSE(decode_rows(whole.substr(0, size), block.columns, block.rows).ok());
      std::string garbage(size, '\0');
      for (char& byte : garbage) byte = static_cast<char>(draws.bits());
      CHECK_FALSE(decode_rows(garbage, block.columns, block.rows).ok());
    }
    for (int n = 0; n < 200; ++n) {
      std::string bytes = whole;
      bytes[draws.below(bytes.size())] ^= static_cast<char>(1u << draws.below(8));
      try_block(block, bytes, block.rows);
    }
    CHECK_FALSE(decode_rows(whole + "x", block.columns, block.rows).ok());
    for (const std::int64_t rows : {std::int64_t{0}, std::int64_t{-1}, block.rows - 1, block.rows + 1, std::int64_t{1} << 30,
                                    std::int64_t{1} << 40, std::numeric_limits<std::int64_t>::max()})
      CHECK_FALSE(decode_rows(whole, block.columns, rows).ok());
    std::vector<SessionColumn> more = block.columns;
    more.push_back({"another", ""});
    CHECK_FALSE(decode_rows(whole, more, block.rows).ok());
    CHECK_FALSE(decode_rows(whole, {}, block.rows).ok());
  }
  // Of single bits, those of coarse_every in a block without coarse columns and the padding of deflate hold no value.
  MESSAGE(refused << " of " << tried << " blocks with one inverted bit were refused");
  CHECK(refused > tried * 9 / 10);
}

TEST_CASE("row codec: counters and constants take next to no room") {
  Block block;
  block.rows = 1000;
  block.columns = {{"tick", ""}, {"flags", ""}};
  for (int n = 0; n < 1000; ++n) block.values.insert(block.values.end(), {1e9 + n, 3.0});
  CHECK(encoded(block).size() < 200);  // 16,000 bytes as doubles
}

}  // namespace
}  // namespace burrhole
