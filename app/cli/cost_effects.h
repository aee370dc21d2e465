/// app/cli/cost_effects.h: the subject `effects` of `burrhole cost`.   Thread  main.
#pragma once

#include <CLI/CLI.hpp>

namespace burrhole::cli {

void add_effects_cost(CLI::App& cost, int& exit_code);

}  // namespace burrhole::cli
