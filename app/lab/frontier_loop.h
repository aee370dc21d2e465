/// app/lab/frontier_loop.h: the whole shipped loop (scene, contact, multi-rate, servo, device) with a constant thrust on the grip. It can
/// be
///   run at one stiffness after the other.
///   Frame  world = bone frame; heights are along +z, out of bone.   Units SI.   Errors  those of the scene.
///   Thread one owner; loops share nothing.
///   The scene is TOML text read by load_scene(), and Stage and Lockstep run it. The lab adds the hand's goal (one thrust, one rest
///   point, no script) and reads the state of the grip.
///   The stiffness of bone is in series with the coupling. It is set to kBoneStiffness, so that a coupling of 1e6 N/m loses 1e-4 of its
///   stiffness, and no correction is needed.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/run/lockstep.h"
#include "app/scene/load.h"
#include "haptics/device/device_hand.h"

namespace burrhole {

inline constexpr double kBoneStiffness = 1e10;  // [N/m]

enum class FrontierBone { plate, sphere };

/// All parameters except the stiffness of the coupling.
struct FrontierLoopConfig {
  SimulatedDeviceConfig device;  ///< device and hand as one body, with the device's limits
  int servo_hz = 1000;           ///< [Hz]
  int contact_ticks = 1;         ///< [ticks] of the servo per contact period; divides servo_hz
  int latency_ticks = 0;         ///< [ticks] of the servo from a motion to its force; -1: one contact period, the default of a scene
  MultiRateScheme scheme = MultiRateScheme::planes;
  double coupling_damping = 0.0;            ///< [N s/m]
  FrontierBone bone = FrontierBone::plate;  ///< a flat plate, or a sphere of the tool's radius
  bool drilling = false;                    ///< the tool spins and removes bone

  /// @returns the time [ticks] from the start until the servo has a force: two contact evaluations and their latency.
  [[nodiscard]] int first_ticks() const noexcept { return 2 * contact_ticks + latency(); }
  [[nodiscard]] int latency() const noexcept { return latency_ticks < 0 ? contact_ticks : latency_ticks; }
};

/// State of the grip at the start, and the force on it afterwards.
struct FrontierStart {
  double height = 0.0;  ///< [m] of the grip above the surface
  double rest = 0.0;    ///< [m] rest position of the hand's spring above the surface
  double thrust = 0.0;  ///< [N] into bone
  int held = 0;  ///< [ticks] for which the grip is kept in place, so that the first contact results are available when it is released
};

/// The grip of a device under a constant thrust.
class PushedGrip final : public HandSource {
 public:
  [[nodiscard]] static Result<PushedGrip> create(const SimulatedDeviceConfig& device, const Pose& world_from_approach, double period);
  void start(const FrontierStart& start) noexcept;
  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override { return hand_.read(); }
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  [[nodiscard]] const SimulatedDevice& device() const noexcept { return *device_; }

 private:
  PushedGrip(std::unique_ptr<SimulatedDevice> device, const DeviceHand& hand) : device_(std::move(device)), hand_(hand) {}
  std::unique_ptr<SimulatedDevice> device_;  // referenced by hand_
  DeviceHand hand_;
  FrontierStart start_;
  int ticks_ = 0;
};

/// State after one tick.
struct FrontierTick {
  double height = 0.0;  ///< [m] true height of the grip above the surface as loaded
  double tool = 0.0;    ///< [m] height of the tool
  double aside = 0.0;   ///< [m] distance of the grip from the axis
  Vec3 shown{0.0};      ///< [N] force of the device on the grip, approach frame
};

/// A run in progress.
class FrontierRun {
 public:
  FrontierRun(std::unique_ptr<PushedGrip> grip, std::unique_ptr<Stage> parts);
  FrontierTick tick();
  [[nodiscard]] Stage& parts() noexcept { return *parts_; }
  [[nodiscard]] Lockstep& lockstep() noexcept { return lockstep_; }

 private:
  std::unique_ptr<PushedGrip> grip_;
  std::unique_ptr<Stage> parts_;
  Lockstep lockstep_;
  Pose approach_from_world_;
};

class FrontierLoop {
 public:
  /// @returns errors of the scene.
  [[nodiscard]] static Result<FrontierLoop> create(const FrontierLoopConfig& config);
  /// Starts a run on bone as loaded. @param stiffness [N/m] of the coupling.
  [[nodiscard]] Result<FrontierRun> begin(double stiffness, const FrontierStart& start) const;
  /// The steps only, for another hand source, which must outlive them.
  [[nodiscard]] Result<std::unique_ptr<Stage>> parts(double stiffness, HandSource& hand) const;
  [[nodiscard]] const FrontierLoopConfig& config() const noexcept { return config_; }
  [[nodiscard]] const Pose& world_from_approach() const noexcept { return world_from_approach_; }

 private:
  FrontierLoop(const FrontierLoopConfig& config, LoadedScene loaded, const Pose& world_from_approach)
      : config_(config), loaded_(std::make_unique<LoadedScene>(std::move(loaded))), world_from_approach_(world_from_approach) {}
  FrontierLoopConfig config_;
  std::unique_ptr<LoadedScene> loaded_;  // runs refer to its tool
  Pose world_from_approach_;
};

}  // namespace burrhole
