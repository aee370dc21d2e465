/// tests/core/contact/friction_support.h: every form of contact on one level plate at z = 0, and a body that a force pushes over it.
///   Units  SI.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "contact_support.h"
#include "core/contact/coupled_contact.h"
#include "core/contact/friction.h"
#include "core/contact/penalty_contact.h"
#include "core/contact/surface_contact.h"
#include "core/contact/voxmap_contact.h"
#include "true_records.h"

namespace burrhole::contact_test {

inline constexpr double kTick = 1e-3;            ///< [s]
inline constexpr double kPointStiffness = 20e3;  ///< [N/m] of penalty points

/// The plate in both forms that contact reads.
class Plate {
 public:
  Plate() : phantom_(phantom_of(spec())), voxels_(phantom_.bone), records_(phantom_) {}
  [[nodiscard]] BoneView view() const { return {voxels_.view(), records_.view(), Pose{}}; }

 private:
  static PhantomSpec spec() {
    PhantomSpec out = small_spec(PhantomKind::plate);
    out.extent = Vec3(0.016, 0.016, 0.008);
    return out;
  }
  Phantom phantom_;
  FeltBone voxels_;
  TrueRecords records_;
};
inline const Plate& plate_bone() {
  static const Plate plate;
  return plate;
}

/// Three by three points, 2 mm wide, facing down.
inline PointShell pad() {
  std::vector<Vec3> points;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) points.push_back(Vec3(x, y, 0.0) * 1e-3);
  PointShell out = shell_of(points);
  out.cutting.assign(points.size(), 0);
  return out;
}

struct Form {
  std::string name;
  std::function<std::unique_ptr<ContactModel>(const PointShell&, const ContactOptions&)> make;
};

inline std::unique_ptr<ContactModel> valid(Result<std::unique_ptr<ContactModel>> made) {
  REQUIRE(made.ok());
  return std::move(made).value();
}

inline std::vector<Form> every_form() {
  const auto gradient = [](const PointShell& shell) { return GradientPlane::create({.stiffness = kPointStiffness}, shell); };
  const auto voxmap = [](const PointShell& shell) { return VoxmapContact::create({.stiffness = kPointStiffness}, shell); };
  return {
      {"surface", [](const PointShell& s, const ContactOptions& o) { return valid(make_surface_contact({}, s, o)); }},
      {"gradient-plane", [=](const PointShell& s, const ContactOptions& o) { return valid(make_penalty_contact(gradient(s), o)); }},
      {"voxmap", [=](const PointShell& s, const ContactOptions& o) { return valid(make_penalty_contact(voxmap(s), o)); }},
      {"gradient-plane, coupled",
       [=](const PointShell& s, const ContactOptions& o) { return valid(make_coupled_contact({}, gradient(s), o)); }},
      {"voxmap, coupled", [=](const PointShell& s, const ContactOptions& o) { return valid(make_coupled_contact({}, voxmap(s), o)); }},
  };
}

/// A body of 0.2 kg in oil of 20 N s/m, pushed by a force over the plate; it does not turn.
class Block {
 public:
  Block(const Form& form, TangentialLaw* law, const ContactOptions& options = {.voxel_edge = kPitch})
      : model_(form.make(pad(), options)), law_(law) {
    hand_.world_from_hand.translation = Vec3(0.0, 0.0, 1e-4);
    model_->place(hand_.world_from_hand);
  }
  void tick(const Vec3& push) {
    const BoneView bone = plate_bone().view();
    model_->step({.bone = bone, .hand = hand_, .dt = kTick, .added = {.tangential = law_}}, state_);
    if ((state_.flags & kContactOutsideWindow) != 0) {
      lost_ = true;  // off the plate: it stays
      return;
    }
    hand_.velocity += kTick / 0.2 * (push + state_.on_hand.force - 20.0 * hand_.velocity);
    hand_.world_from_hand.translation += kTick * hand_.velocity;
  }
  void run(double seconds, const std::function<Vec3(double)>& push) {
    const int ticks = static_cast<int>(seconds / kTick + 0.5);
    for (int n = 0; n < ticks; ++n) tick(push(n * kTick));
  }
  [[nodiscard]] const Vec3& place() const noexcept { return hand_.world_from_hand.translation; }
  [[nodiscard]] const ContactState& state() const noexcept { return state_; }
  [[nodiscard]] bool lost() const noexcept { return lost_; }

 private:
  std::unique_ptr<ContactModel> model_;
  TangentialLaw* law_;
  HandMotion hand_;
  ContactState state_;
  bool lost_ = false;
};

}  // namespace burrhole::contact_test
