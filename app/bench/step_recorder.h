/// app/bench/step_recorder.h: records the inputs of bone steps of the shipped parietal scene, from the step on in which the tip has passed
///   half of the bone, with the bone before the first and after the last of them.
///   Frame  index.   Units  SI.   Thread  main.   Errors  those of load_scene(), Voxmap::create() and place_window(); internal if the run
///   ended before the last step.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/scene/load.h"
#include "app/stage/slots.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// What erosion reads in one step.
struct StepInput {
  Cut cut;
  double spin = 0.0;  ///< [rev/s]
  double dt = 0.0;    ///< [s]
};

struct RecordedSteps {
  std::unique_ptr<LoadedScene> loaded;
  std::vector<StepInput> inputs;
  std::unique_ptr<Voxmap> before;
  VoxelBox window;           ///< around the windows of all steps
  VoxelBox after_box;        ///< window after the last step
  std::vector<float> after;  ///< [-] remaining after the last step, over after_box
};

/// Drills with a shipped tool and the scene's hand. @param quick uses a tool that cuts ten times as fast, for a short run.
[[nodiscard]] Result<RecordedSteps> record_bone_steps(const std::string& tool, std::size_t steps, bool quick);

/// @returns a copy of `bone`, which is written back, with its cut surface and with the window at `window`. @param model its bone as loaded.
[[nodiscard]] Result<Voxmap> copy_of_bone(const std::shared_ptr<const BoneModel>& model, Voxmap& bone, const VoxelBox& window);

}  // namespace burrhole
