/// app/stage/stage_config.h: configuration common to all scenes: run, bone, tool, approach, hand and servo.
///   Frame  bone frame unless stated.   Units  SI; keys in the file carry their unit and are converted when read (app/scene).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/measure/approach.h"
#include "haptics/hand/feed_hand.h"
#include "haptics/hand/goal_hand.h"
#include "haptics/hand/simulated_hand.h"
#include "haptics/servo/servo_step.h"
#include "volumes/import_bone.h"
#include "volumes/phantom/phantom_spec.h"

namespace burrhole {

/// A file or folder to import. The centre of the cropped region is computed from the approach.
struct ScanScene {
  ImportRequest request;
  std::optional<Vec3> region;  ///< [m] size of the box round the approach to which the scan is cropped; key region_mm
};

/// [volume]
struct VolumeScene {
  std::optional<PhantomSpec> phantom;
  std::optional<ScanScene> scan;     ///< when no phantom; .vdb files too
  std::string place;                 ///< place of key `source` in the file, for errors
  std::string spacing_place;         ///< place of key `spacing_mm`, or of `source` without it, for warnings
  Pose world_from_bone;              ///< keys position_mm, turn_deg (about x, then y, then z)
  double gradient_dead_zone = 0.08;  ///< [1/voxel] shorter gradients of the density are zero
};

/// [tool]
struct ToolScene {
  std::string path;            ///< resolved path of the tool file
  std::string place;           ///< place of the tool's name in the file, for errors
  double spin = 0.0;           ///< [rev/s] key spin_rpm
  double erosion_scale = 1.0;  ///< [-] key erosion_scale: multiplies every erosion factor (tuning, tests)
};

struct StageConfig {
  std::string file;
  std::string text;  ///< with overrides applied
  std::string title;
  double duration = 120.0;  ///< [s] upper limit of simulated time; key duration_s
  int servo_hz = 1000;      ///< [Hz] key servo_hz
  VolumeScene volume;
  ToolScene tool;
  ApproachScene approach;
  HandConfig hand;
  std::optional<FeedHandConfig> feed_hand;    ///< in place of the script: hand.kind = "feed"
  std::optional<GoalHandConfig> goal_hand;    ///< in place of the script: hand.kind = "mouse"
  std::optional<std::uint64_t> memory_limit;  ///< [bytes] key memory_mb of [limits]; absent: none
  std::string memory_place;                   ///< place of that key in the file, for errors
  ServoConfig servo;                          ///< table [servo]; its rates follow from the effects' requirements
  // Energy detector of the servo. Where a key is absent, energy_config() of force_loop.h computes the value from [device], and it is 0
  // without [device].
  std::optional<double> relied_on;         ///< [N s/m] guaranteed damping of device and hand; key relied_on_N_s_per_m of [servo]
  std::optional<double> energy_tolerance;  ///< [J] passivity deficit above which a fault is latched; 0: off; key energy_mJ of [servo]
};

}  // namespace burrhole
