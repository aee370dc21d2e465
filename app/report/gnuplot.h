/// app/report/gnuplot.h: runs the gnuplot program on a script. No other file starts it.
///   Errors  unavailable, internal.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"

namespace burrhole {

/// Runs `program` on a script and waits. @param last how the output of the script's terminal ends, apart from line breaks: gnuplot does not
/// report a write that failed. @returns its output on stdout. Errors: unavailable if the program does not exist, or its temporary files
/// cannot be written; internal, with the first line of its error output, if it exits with an error.
[[nodiscard]] Result<std::string> run_gnuplot(std::string_view script, const std::string& program, std::string_view last);

/// @returns text in double quotes: backslash and quote escaped, control characters replaced by blanks.
[[nodiscard]] std::string gnuplot_quoted(const std::string& text);

}  // namespace burrhole
