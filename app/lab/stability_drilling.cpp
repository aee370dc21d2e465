// Bone is removed during contact.
#include "app/lab/stability_parts.h"
#include "core/base/units.h"

namespace burrhole::stability {

void add_drilling(std::vector<StabilityCase>& out) {
  StabilityCase shell;
  shell.name = "shell_through";
  shell.shows = "A ball drills through a shell of 1 mm and comes out on the other side.";
  shell.scene = scene({.volume = "source = \"phantom:plate\"\nextent_mm = [16, 16, 10]\nthickness_mm = 1\n", .drills = true});
  shell.tool = ball();
  shell.path = {{0.0, {0.0, 0.0, 1e-3}}, {1.0, {0.0, 0.0, -3e-3}}, {3.0, {0.0, 0.0, -7e-3}}};
  shell.duration = 5.0;
  shell.checks =
      with(always(), {{StabilityMeasure::attractive_force, kAttractiveForce}, {StabilityMeasure::rest_speed, kRestSpeed, {4.8, 5.0}}});
  shell.sabotage = {.what = "the sign of the force is flipped", .must_fail = StabilityMeasure::passivity_deficit, .flip = true};
  out.push_back(shell);
  StabilityCase layers = shell;
  layers.name = "hardness_jump";
  layers.shows = "A ball drills from a hard table into soft diploe and into a hard table again.";
  layers.scene = scene(
      {.volume = "source = \"phantom:skull_patch\"\nextent_mm = [16, 16, 10]\nthickness_mm = 4\nouter_table_mm = 1.5\ninner_table_mm = 1\n",
       .drills = true});
  layers.path = {{0.0, {0.0, 0.0, 1e-3}}, {0.5, {0.0, 0.0, -3e-3}}, {4.0, {0.0, 0.0, -10e-3}}};
  layers.duration = 4.0;
  layers.checks = with(always(), {{StabilityMeasure::attractive_force, kAttractiveForce}});
  out.push_back(layers);
}

}  // namespace burrhole::stability
