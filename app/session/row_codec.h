/// app/session/row_codec.h: a block of rows of one stream as bytes and back. Pure functions; zlib stays in row_codec.cpp.
///
/// Block format 1, all integers little-endian:
///   1 byte   1
///   4 bytes  coarse_every
///   rest     one zlib stream [RFC 1950] of the payload: coarse_every and the number of rows (4 bytes each), then column after
///            column
/// A column of words is written as byte 0 (the lowest) of all its words, then byte 1 of all, ...
///   exact    1 byte method, then one 8-byte word a row; the value before the first row is 0.
///            method 0: the bits of the value XOR those of the value before
///            method 1, all values being integers: the difference d from the value before, as 2d for d >= 0 and -2d - 1 for d < 0
///   coarse   one 4-byte word for each row n of the block with n mod coarse_every == 0: the bits of the value as float XOR those before
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/session/session.h"

namespace burrhole {

/// @param values rows * columns.size() values, row after row, at least one row. @param coarse_every > 0, rows.
[[nodiscard]] std::string encode_rows(std::span<const double> values, std::span<const SessionColumn> columns, std::int64_t coarse_every);

/// @returns rows * columns.size() values, row after row. Exact columns are bit-exact. Coarse columns are floats; a row that was not stored
/// has the value of the last stored row. bad_input, without a place: `bytes` is not such a block. Memory is limited by the size of the
/// block.
[[nodiscard]] Result<std::vector<double>> decode_rows(std::string_view bytes, std::span<const SessionColumn> columns, std::int64_t rows);

/// Rows of schema 1: little-endian IEEE 754 doubles, row after row. @returns as decode_rows.
[[nodiscard]] Result<std::vector<double>> decode_plain_rows(std::string_view bytes, std::size_t columns, std::int64_t rows);

}  // namespace burrhole
