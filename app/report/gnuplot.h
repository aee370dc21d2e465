/// app/report/gnuplot.h: runs the gnuplot program on a script; nothing else knows how it is called.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"

namespace burrhole {

/// Runs `program` on a script and waits. @returns what it wrote to stdout. Errors: unavailable if the program is not there or no temporary
/// file can be made; internal, with the first line of its complaint, if it ends with a fault.
[[nodiscard]] Result<std::string> run_gnuplot(std::string_view script, const std::string& program);

/// Text between double quotes: backslash and quote escaped, control characters made blanks.
[[nodiscard]] std::string gnuplot_quoted(const std::string& text);

}  // namespace burrhole
