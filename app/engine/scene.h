/// app/engine/scene.h: a scene file as plain values. An effect exists if, and only if, its table is there.
///   Units SI; keys in the file carry their unit and are converted here and nowhere else.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/engine/view.h"
#include "app/engine/volume_scene.h"
#include "core/base/toml.h"
#include "core/contact/constrained_tool.h"
#include "core/contact/gradient_plane.h"
#include "core/contact/virtual_coupling.h"
#include "core/contact/voxmap_contact.h"
#include "core/drill/erosion.h"
#include "haptics/device/device_hand.h"
#include "haptics/hand/simulated_hand.h"
#include "haptics/servo/servo_step.h"

namespace burrhole {

/// [tool]
struct ToolScene {
  std::string path;                   ///< of the tool file, resolved
  std::string place;                  ///< of the name, for faults found later
  double spin = 0.0;                  ///< [rev/s] key spin_rpm
  double erosion_pitch_voxels = 0.5;  ///< key point_pitch_voxels of [erosion]
  double erosion_scale = 1.0;         ///< key erosion_scale: multiplies every erosion factor (tuning, tests)
};

/// [approach]: bone frame.
struct ApproachScene {
  Vec3 entry{0.0};            ///< [m] near the outer surface; moved onto it along the axis
  Vec3 axis{0.0, 0.0, -1.0};  ///< unit, into bone
  std::string place;          ///< of the table, for faults found later
};

/// How a touch becomes a force.
enum class ContactModelKind { surface, gradient_plane, voxmap };
enum class ContactStorage { window, vdb };

/// [contact]
struct ContactScene {
  ContactModelKind model = ContactModelKind::surface;
  ConstrainedToolConfig surface;                          ///< of the models, the one in use
  RecordPrecision record_bits = RecordPrecision::bits16;  ///< surface
  LabelFactors label_stiffness = kAllAlike;               ///< surface
  GradientPlaneConfig gradient_plane;                     ///< mode = "paper" collides on any density
  ContactStorage storage = ContactStorage::window;        ///< gradient-plane
  VoxmapContactConfig voxmap;
  std::optional<VirtualCouplingConfig> coupling;  ///< gradient-plane and voxmap: the tool is a body on a spring instead of the hand's
  int rate_hz = 1000;
  int latency_ticks = -1;  ///< servo ticks between a motion and its force; -1: one contact period

  /// Whether the tool is a body of its own that bone holds back; otherwise it is where the hand is.
  [[nodiscard]] bool holds_back() const noexcept { return model == ContactModelKind::surface; }
};

/// [erosion]
struct ErosionScene {
  ErosionConfig config;
  int rate_hz = 100;
};

/// [device]: a force device between the hand and the drill. This version simulates one.
struct DeviceScene {
  SimulatedDeviceConfig config;
  std::string hand = "nominal";       ///< who holds it
  std::optional<double> force_scale;  ///< newtons at the grip for one in the world; nothing: what shows the script's push as all it has
  double position_scale = 1.0;        ///< metres in the world for one of the grip
};

/// [spindle]
struct SpindleScene {
  double stall_torque = 2.0;  ///< [N m]
  double inertia = 1e-4;      ///< [kg m^2]
};

/// Where pictures are cut open: nowhere, at a plane through a point, or at the tip's depth, square to the view.
enum class CutKind { none, plane, tip };
struct CutScene {
  CutKind kind = CutKind::none;
  Vec3 point{0.0};   ///< [m] bone frame; of a plane
  Vec3 normal{0.0};  ///< bone frame, towards what is cut away; of a plane
};

/// [display]
struct DisplayScene {
  std::string method = "raycast";  ///< "raycast" or "slices"
  double slices_per_voxel = 1.0;
  bool opacity_correction = true;
  TransferFunction transfer;                 ///< empty: bone is drawn by its surface; key shading = "translucent"
  DrawingQuality quality{.supersample = 2};  ///< a handful of still pictures: smooth edges are worth four times the pixels
  std::optional<double> budget;  ///< [s] of a picture, by which the quality is chosen (quality = "auto"); nothing: as the keys say
  LookView looks{.tissue = true, .occlusion = true};
  BackgroundView background;
  int width = 1200, height = 900;
  std::size_t upload_budget = std::size_t{64} << 20;  ///< [byte] of texels for one picture; key upload_budget_kb
  double upload_time = 0.0;                           ///< [s] that making them may take; 0: any; key upload_budget_ms
  double azimuth = 0.61;                              ///< [rad] of the camera round the axis, from the patient's -y
  double elevation = 0.75;                            ///< [rad] above the tangent plane
  double distance = 0.074;                            ///< [m] from the entry
  bool scale_bar = true;
  CutScene cut;
  StereoView stereo;
};

/// [record]
struct RecordScene {
  std::string path = "session.sqlite";  ///< relative to the output folder
};

struct Scene {
  std::string file;
  std::string text;  ///< with overrides applied
  std::string title;
  double duration = 120.0;  ///< [s] of simulated time at most; key duration_s
  int servo_hz = 1000;      ///< key servo_hz
  VolumeScene volume;
  ToolScene tool;
  ApproachScene approach;
  HandConfig hand;
  ServoConfig servo;  ///< table [servo]; its rates follow from the others
  std::optional<DeviceScene> device;
  std::optional<ContactScene> contact;
  std::optional<ErosionScene> erosion;
  std::optional<SpindleScene> spindle;
  std::optional<DisplayScene> display;
  std::optional<RecordScene> record;
};

/// Where names of tools are looked up, in order, after the scene's own folder.
struct SceneContext {
  std::vector<std::string> tool_folders;
  bool tool_given = false;  ///< the tool's text is at hand (replay): its file is not looked for
};

/// @returns nothing when any issue was pushed; all faults of the file are pushed. An issue with code `unavailable` means exit code 4.
/// `log`: also tells which keys were asked for.
[[nodiscard]] std::optional<Scene> read_scene(const TomlDocument& document, const SceneContext& context, Issues& issues,
                                              KeyLog* log = nullptr);

}  // namespace burrhole
