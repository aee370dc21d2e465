/// app/cli/frontier_option.h: `--map` of `burrhole stability`.
#pragma once

#include <string>

namespace burrhole::cli {

/// Measures the stability frontier on `workers` threads (0: all cores) with a progress bar, and writes frontier.csv, plots and a page into
/// the folder. @returns the exit code.
int run_frontier(const std::string& folder, unsigned workers, bool quiet);

}  // namespace burrhole::cli
