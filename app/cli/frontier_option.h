/// app/cli/frontier_option.h: `--map` of `burrhole stability`.
#pragma once

#include <string>

namespace burrhole::cli {

/// Measures the frontier on `workers` threads, 0 for all cores, with a bar, and writes frontier.csv, its plots and its page into the
/// folder. @returns the exit code.
int run_frontier(const std::string& folder, unsigned workers, bool quiet);

}  // namespace burrhole::cli
