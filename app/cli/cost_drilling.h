/// app/cli/cost_drilling.h: the subject `drilling` of `burrhole cost`.   Thread  main.
#pragma once

#include <CLI/CLI.hpp>

namespace burrhole::cli {

void add_drilling_cost(CLI::App& cost, int& exit_code);

}  // namespace burrhole::cli
