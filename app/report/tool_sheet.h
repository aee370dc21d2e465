/// app/report/tool_sheet.h: one bit on one sheet, for its designer or user: the bit, its point shell with the inward normals, and a section
///   with its erosion factors. Drawn by gnuplot as PNG.
///   Units  mm in the picture.   Errors  unavailable, bad_input.   Source  the three views are those of [AcostaLiu07] Figs. 3 and 6.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/tool/tool.h"

namespace burrhole {

inline constexpr int kToolSheetWidth = 1540, kToolSheetHeight = 780;  // [px]

struct ToolSheet {
  const Tool* tool = nullptr;      ///< its erosion points are drawn in the third panel: a fine pitch gives a fine picture
  std::string headline, subtitle;  ///< one line each
};

/// @returns the commands for gnuplot, including pictures and points. Pure: the same sheet gives the same text.
[[nodiscard]] std::string tool_sheet_script(const ToolSheet& sheet);

/// Draws into a PNG file. Errors: unavailable without gnuplot; bad_input with the path if the file cannot be written.
[[nodiscard]] Status write_tool_sheet(const ToolSheet& sheet, const std::string& path, const std::string& gnuplot = "gnuplot");

}  // namespace burrhole
