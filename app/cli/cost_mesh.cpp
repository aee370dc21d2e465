#include "app/cli/cost_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "app/cli/commands.h"
#include "app/cli/cost_study.h"
#include "app/lab/mesh_cost.h"

namespace burrhole::cli {
namespace {

struct MeshCostArguments {
  StudyFolder folder{.folder = "out/cost_mesh", .partial = "partial_mesh.txt"};
  bool quick = false, json = false;
};

int run_mesh_cost(const MeshCostArguments& arguments) {
  const auto lock = begin_study(arguments.folder);
  if (!lock) return report(lock.error());
  Progress progress(arguments.json, {}, true);
  MeshCostOptions options = arguments.quick ? quick_mesh_cost() : MeshCostOptions{};
  Study study(study_runs(arguments.folder, progress), count_of_trials(options));
  options.study = &study;
  const auto cost = measure_mesh_cost(options);
  if (!cost) return report(cost.error());
  if (const Status written = write_mesh_cost(*cost, arguments.folder.folder); !written) return report(written.error());
  end_study(arguments.folder);
  if (arguments.json) {
    print(mesh_cost_json(*cost));
    return std::ranges::all_of(mesh_bounds(*cost), &MeshBound::pass) ? kDone : kCheckFailed;
  }
  print(mesh_cost_tables(*cost));
  bool failed = false;
  for (const MeshBound& bound : mesh_bounds(*cost)) {
    if (bound.pass()) continue;
    failed = true;
    print(fmt::format("{} is {:.3g}, bound {:g}\n", bound.name, bound.value, bound.bound));
  }
  print(fmt::format("{} rows in {}/cost.csv, mesh.md, mesh.svg, mesh_growth.svg and mesh.html beside it; {}\n",
                    mesh_cost_rows(*cost).size(), arguments.folder.folder, failed ? "bounds failed" : "all within their bounds"));
  return failed ? kCheckFailed : kDone;
}

}  // namespace

void add_mesh_cost(CLI::App& cost, int& exit_code) {
  CLI::App* command = add_command(
      cost, "mesh", "Subjects",
      {.summary = "Accuracy of a bone mesh against the time of an update",
       .about =
           "Meshes bodies with a known surface by ball pivoting, by OpenVDB's volumeToMesh and by surface nets. Tables the distance to "
           "the surface in both directions, volume, angles, holes and memory, and the CPU time of an update after 20^3 voxels have "
           "changed, in models of 64^3 to 512^3 voxels. Checks that an update of the pivoted mesh is 50 times faster than full pivoting, "
           "as fast per triangle, and independent of the size of the model. An interrupted call is resumed.",
       .examples = {"burrhole cost mesh --out out/cost_mesh", "burrhole cost mesh --quick --json"},
       .exits = "Exit 3 if a bound fails."});
  auto arguments = std::make_shared<MeshCostArguments>();
  add_study_options(*command, arguments->folder, "the tables, the plots and the page");
  command->add_flag("--quick", arguments->quick, "fewer repeats, and no model of 512^3");
  command->add_flag("--json", arguments->json, "print only the rows of cost.csv and the bounds on stdout, as JSON");
  add_simd_option(*command);
  command->callback([arguments, &exit_code] { exit_code = run_mesh_cost(*arguments); });
}

}  // namespace burrhole::cli
