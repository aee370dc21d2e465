/// app/cli/standard_streams.h: standard output and error of the program. What cannot be written to standard output is an error; what cannot
///   be written to standard error is lost, and changes nothing.
///   Thread  main for print(); any for note().
#pragma once

#include <string>

namespace burrhole::cli {

/// Standard output cannot be written. Thrown by print(), and caught by main() alone: no command goes on without its output.
struct NoOutput {
  int code;  ///< errno
};

/// Call it before the first file is opened. Opens what is closed of the standard streams, so that no output file takes their place, and
/// makes a write beyond the limit of the size of files (ulimit -f), or to a pipe whose reader has gone, an error instead of a signal.
void prepare_streams();

/// Prints to stdout and flushes it. Control characters but the ends of lines and tabulators are escaped: texts of files may hold some. Throws
/// NoOutput.
void print(const std::string& text);
/// Prints to stderr.
void note(const std::string& text) noexcept;
/// Reports that standard output cannot be written; quietly if its reader has gone. @returns the exit code.
[[nodiscard]] int report(const NoOutput& failure);

}  // namespace burrhole::cli
