/// app/report/gnuplot.h: runs the gnuplot program on a script. No other file starts it.
///   Errors  unavailable, internal.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"

namespace burrhole {

/// Runs `program` on a script and waits. @returns its output on stdout. Errors: unavailable if the program does not exist or no temporary
/// file can be created; internal, with the first line of its error output, if it exits with an error.
[[nodiscard]] Result<std::string> run_gnuplot(std::string_view script, const std::string& program);

/// @returns text in double quotes: backslash and quote escaped, control characters replaced by blanks.
[[nodiscard]] std::string gnuplot_quoted(const std::string& text);

}  // namespace burrhole
