/// app/cli/cost_mesh.h: the subject `mesh` of `burrhole cost`.   Thread  main.
#pragma once

#include <CLI/CLI.hpp>

namespace burrhole::cli {

void add_mesh_cost(CLI::App& cost, int& exit_code);

}  // namespace burrhole::cli
