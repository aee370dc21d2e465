/// app/lab/frontier_loop.h: the whole shipped loop (scene, contact, multi-rate, servo, device) with a constant thrust on the grip, to be
///   run at one stiffness after the other.
///   Frame  world = bone frame; heights are along +z, out of bone.   Units SI.   Thread one owner; loops share nothing.
///   The scene is TOML text through load_scene(), and DrillParts and Lockstep run it; of the lab's own are the hand's goal (one thrust, one
///   rest point, no script) and what is read off the grip.
///   Bone gives way by its own stiffness in series with the coupling. It is set to kBoneStiffness here, so that a coupling of 1e6 N/m loses
///   1e-4 of its stiffness, and nothing is corrected.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/engine/load.h"
#include "app/engine/lockstep.h"
#include "haptics/device/device_hand.h"

namespace burrhole {

inline constexpr double kBoneStiffness = 1e10;  // [N/m]

enum class FrontierBone { plate, sphere };

/// Everything but the coupling's stiffness.
struct FrontierLoopConfig {
  SimulatedDeviceConfig device;  ///< the body held, what it can tell and show
  int servo_hz = 1000;
  int contact_ticks = 1;  ///< servo ticks in a contact period; divides servo_hz
  int latency_ticks = 0;  ///< servo ticks from a motion to its force; -1: one contact period, as a scene's default
  MultiRateScheme scheme = MultiRateScheme::planes;
  double coupling_damping = 0.0;            ///< [N s/m]
  FrontierBone bone = FrontierBone::plate;  ///< a flat plate, or a sphere of the tool's own radius
  bool drilling = false;                    ///< the tool spins and bone goes

  /// [ticks] from the start until the servo has a force: of two looks and their way.
  [[nodiscard]] int first_ticks() const noexcept { return 2 * contact_ticks + latency(); }
  [[nodiscard]] int latency() const noexcept { return latency_ticks < 0 ? contact_ticks : latency_ticks; }
};

/// Where the grip is at the start, and what pushes it from then on.
struct FrontierStart {
  double height = 0.0;  ///< [m] of the grip over the surface
  double rest = 0.0;    ///< [m] of the hand's spring over the surface
  double thrust = 0.0;  ///< [N] into bone
  int held = 0;         ///< [ticks] for which the grip is kept where it is, so that contact's first results are there when it is let go
};

/// A device's grip under a constant thrust.
class PushedGrip final : public HandSource {
 public:
  [[nodiscard]] static Result<PushedGrip> create(const SimulatedDeviceConfig& device, const Pose& world_from_approach, double period);
  void start(const FrontierStart& start) noexcept;
  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override { return hand_.read(); }
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  [[nodiscard]] const SimulatedDevice& device() const noexcept { return *device_; }

 private:
  PushedGrip(std::unique_ptr<SimulatedDevice> device, const DeviceHand& hand) : device_(std::move(device)), hand_(hand) {}
  std::unique_ptr<SimulatedDevice> device_;  // the hand points at it
  DeviceHand hand_;
  FrontierStart start_;
  int ticks_ = 0;
};

/// One tick as the lab reads it.
struct FrontierTick {
  double height = 0.0;  ///< [m] of the grip itself over the surface as loaded, not as told
  double tool = 0.0;    ///< [m] the same of the tool
  double aside = 0.0;   ///< [m] of the grip off the axis
  Vec3 shown{0.0};      ///< [N] force of the device on the grip, approach frame
};

/// A run in progress.
class FrontierRun {
 public:
  FrontierRun(std::unique_ptr<PushedGrip> grip, std::unique_ptr<DrillParts> parts);
  FrontierTick tick();
  [[nodiscard]] DrillParts& parts() noexcept { return *parts_; }
  [[nodiscard]] Lockstep& lockstep() noexcept { return lockstep_; }

 private:
  std::unique_ptr<PushedGrip> grip_;
  std::unique_ptr<DrillParts> parts_;
  Lockstep lockstep_;
  Pose approach_from_world_;
};

class FrontierLoop {
 public:
  /// Faults of the scene's text pass through.
  [[nodiscard]] static Result<FrontierLoop> create(const FrontierLoopConfig& config);
  /// A fresh run on unhurt bone. @param stiffness [N/m] of the coupling.
  [[nodiscard]] Result<FrontierRun> begin(double stiffness, const FrontierStart& start) const;
  /// The steps alone, for a hand of another kind, which must outlive them.
  [[nodiscard]] Result<std::unique_ptr<DrillParts>> parts(double stiffness, HandSource& hand) const;
  [[nodiscard]] const FrontierLoopConfig& config() const noexcept { return config_; }
  [[nodiscard]] const Pose& world_from_approach() const noexcept { return world_from_approach_; }

 private:
  FrontierLoop(const FrontierLoopConfig& config, LoadedScene loaded, const Pose& world_from_approach)
      : config_(config), loaded_(std::make_unique<LoadedScene>(std::move(loaded))), world_from_approach_(world_from_approach) {}
  FrontierLoopConfig config_;
  std::unique_ptr<LoadedScene> loaded_;  // runs point at its tool
  Pose world_from_approach_;
};

}  // namespace burrhole
