// A client of the installed package: drills the shipped scene, reads density and forces while it drills, writes summary and report.
#include <burrhole/app/job/drill_job.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace burrhole;
  if (argc != 4) return std::fputs("usage: client SCENE TOOL_FOLDER OUTPUT_FOLDER\n", stderr), 2;
  auto document = TomlDocument::load(argv[1]);
  if (!document) return std::puts(document.error().text().c_str()), 2;
  if (const Status set = document->set("duration_s=4"); !set) return std::puts(set.error().text().c_str()), 2;
  Issues issues;
  const auto loaded = load_scene(*document, {.tool_folders = {argv[2]}}, issues);
  if (!loaded) return std::puts(issues.front().text().c_str()), 2;

  double largest_force = 0.0;                   // [N]
  float first_density = -1.0f, density = 0.0f;  // [-]
  DrillJob job;
  job.folder = argv[3];
  job.watch = [&](Simulation& simulation) {  // ten times a simulated second
    largest_force = std::max(largest_force, glm::length(simulation.contact_state().on_hand.force));
    const Vec3 entry = loaded->bone->bone_from_index().inverse() * simulation.approach().bone_from_approach.translation;
    const Vec3i voxel = floor_int(entry - Vec3(0.0, 0.0, 1.0));  // one voxel below the surface, on the axis, where the bit cuts least
    simulation.voxmap().read_density({voxel, voxel + 1}, {&density, 1});
    if (first_density < 0.0f) first_density = density;
  };
  const auto summary = drill(*loaded, job);
  if (!summary) return std::puts(summary.error().text().c_str()), 1;
  std::printf("client: drilled, %.1f N at most, density below the entry from %.2f to %.2f, %.1f mm3 removed\n", largest_force,
              first_density, density, summary->removed_mm3);
  return largest_force > 1.0 && first_density > 0.99f && density < 0.5f && summary->removed_mm3 > 1.0 ? 0 : 1;
}
