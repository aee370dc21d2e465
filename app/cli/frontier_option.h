/// app/cli/frontier_option.h: `--map` of `burrhole stability`.
#pragma once

#include <string>

namespace burrhole::cli {

/// Measures the stability frontier (app/lab/frontier.h) and writes frontier.csv, its plots (SVG) and frontier.html into the folder. Prints
/// a progress bar on stderr and the number of rows on stdout. @param workers number of threads; 0: one per core. @param quiet prints errors
/// only. @returns the exit code.
int run_frontier(const std::string& folder, unsigned workers, bool quiet);

}  // namespace burrhole::cli
