#include "tests/app/run/surface_twin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace burrhole::test {
namespace {

// The twin's own. Of them the play alone moves the force of a period by more than the bound of surface_head_test.cpp (a whole voxel: 2.4 %).
constexpr double kPlay = 0.5;           // [voxel] by which cutting points are drawn in across the push: voxels round a wall by half of one
constexpr double kNear = 1.4;           // [voxel] points farther from the surface take no part
constexpr double kStep = 0.23;          // [voxel] a point moves at most between two looks
constexpr double kRests = 0.003;        // [voxel] the last move of a period is no longer
constexpr double kStraight = -0.1;      // [-] a flank that leans away from the push by less presses on bone
constexpr double kSoftest = 1.0 / 255;  // [-] the least relative stiffness but none that a byte shows
constexpr int kMoves = 60, kSweeps = 400;

Vec3 rotation_vector(const Quat& q) {
  const double sign = q.w < 0.0 ? -1.0 : 1.0;
  const Vec3 v = sign * Vec3(q.x, q.y, q.z);
  const double s = glm::length(v);
  return s < 1e-14 ? 2.0 * v : v / s * (2.0 * std::atan2(s, sign * q.w));
}

Quat turned_by(const Vec3& vector) {
  const double angle = glm::length(vector);
  return angle < 1e-14 ? Quat(1.0, 0.0, 0.0, 0.0) : glm::angleAxis(angle, vector / angle);
}

struct Touch {
  std::size_t point;
  Vec3 normal, arm, lever;  // lever: arm x normal
  double gap, yield, force;
  bool cutting;
  bool spring = false;  // holds both ways
};

/// Records interpolated plainly; false where a corner is not known or bone has no direction.
bool look_up(const SurfaceView& bone, const Vec3& p_bone, double& gap, Vec3& normal) {
  const Vec3 index = bone.records.bone_from_index.inverse() * p_bone, base = glm::floor(index), t = index - base;
  gap = 0.0;
  normal = Vec3(0.0);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 step(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    const Vec3i v(base + step);
    if (!bone.records.box.contains(v)) return false;
    const Vec3 weight = glm::mix(1.0 - t, t, step);
    const std::size_t at = bone.records.box.offset_of(v);
    const SurfaceSample s = bone.records.records16 != nullptr ? decode(bone.records.records16[at]) : decode(bone.records.records8[at]);
    const Vec3 way = bone.records.bone_from_index.linear * (t - step) / bone.records.bone_from_index.mean_edge();
    gap += weight.x * weight.y * weight.z * (s.distance + 0.5 * glm::dot(s.normal, way));
    normal += weight.x * weight.y * weight.z * s.normal;
  }
  if (glm::length(normal) < 0.1) return false;
  normal = glm::normalize(normal);
  return true;
}

class Plain {
 public:
  Plain(const ConstrainedToolConfig& config, const PointShell& shell, const SurfaceView& bone, const TwinStart& start)
      : config_(config),
        shell_(shell),
        bone_(bone),
        edge_(bone.records.bone_from_index.mean_edge()),
        pose_(start.bone_from_tool),
        engaged_(start.engaged),
        cutting_give_(1.0 / config.cutting_stiffness) {
    const double e = glm::length(engaged_);
    play_ = std::min(e, kPlay * edge_);
    push_ = e > 0.0 ? glm::conjugate(pose_.rotation) * engaged_ / e : Vec3(0.0, 0.0, 1.0);
    aside_ = start.aside;
    to_cut_ = start.to_cut;
    if (e > 0.0) hold_sideways();
  }

  TwinForce run(const HandMotion& hand, const TwinStart& start, double dt, bool spinning) {
    const Pose hand_in_bone = bone_.world_from_bone.inverse() * hand.world_from_hand;
    const double damping = config_.coupling_damping / dt, k = config_.coupling_stiffness + damping;
    const double share = config_.coupling_stiffness / k;
    const Vec3 velocity = bone_.world_from_bone.inverse().rotate(hand.velocity);
    const Vec3 target = share * hand_in_bone.translation + (1.0 - share) * (pose_.translation + velocity * dt);
    const Quat before_in_bone = (bone_.world_from_bone.inverse() * Pose{start.hand_before, Vec3(0.0)}).rotation;
    const Vec3 turn = share * rotation_vector(hand_in_bone.rotation * glm::conjugate(pose_.rotation)) +
                      (1.0 - share) * rotation_vector(hand_in_bone.rotation * glm::conjugate(before_in_bone));
    const Quat turned = turned_by(turn) * pose_.rotation;
    TwinForce out;
    for (out.moves = 1; out.moves <= kMoves; ++out.moves)
      if (move(target, turned, k, config_.turn_stiffness / share, spinning)) break;
    for (const Touch& touch : touches_) out.force += touch.normal * touch.force;
    out.points = static_cast<int>(touches_.size());
    out.after = {pose_, engaged_, settled(start), hand.world_from_hand.rotation, to_cut_};
    return out;
  }

 private:
  /// How far aside the tool is left, by the words of flank_friction.h: what was cut is let go. Flanks hold no more than the thrust that engages them.
  Vec3 settled(const TwinStart& start) {
    if (grips_.empty() || gone()) return Vec3(0.0);
    const auto across = [&](const Vec3& v) { return v - world_push_ * glm::dot(v, world_push_); };
    const Vec3 moved = pose_ * grip_at_ - grip_start_;
    Vec3 aside = across(aside_ + moved), force(0.0);
    const double depth = std::max(glm::dot(engaged_, world_push_), 1e-9);
    const double receded = -glm::dot(moved + engaged_ - start.engaged, world_push_);
    to_cut_ = std::max(start.to_cut + receded, -depth);
    if (to_cut_ > 0.0) aside *= std::max(0.0, 1.0 - to_cut_ / depth);
    to_cut_ = std::min(to_cut_, 0.0);
    double thrust = 0.0;
    Vec3 cut(0.0);
    for (const Touch& touch : touches_)
      if (touch.cutting) cut += touch.normal * touch.force;
    thrust = glm::length(cut);
    for (const Grip& grip : grips_) force += grip.axis * (grip.stiffness * glm::dot(grip.axis, aside));
    return glm::length(force) > thrust ? aside * (thrust / glm::length(force)) : aside;
  }
  /// Where a cutting point is looked for, tool frame.
  Vec3 drawn_in(std::size_t n) const {
    const Vec3& in = shell_.inward_normals[n];
    return shell_.positions[n] + (in - push_ * glm::dot(in, push_)) * play_;
  }
  /// The tensor of flank_friction.h, from every cutting point under the surface at the true pose; all in the tool frame, where push_ is.
  void hold_sideways() {
    double along = 0.0;
    Mat3 flanks(0.0);
    for (std::size_t n = 0; n < shell_.size(); ++n) {
      if (shell_.cutting[n] == 0) continue;
      double gap = 0.0;
      Vec3 unused;
      const Vec3 in = shell_.inward_normals[n];
      const bool known = look_up(bone_, pose_ * drawn_in(n), gap, unused) || unused == Vec3(0.0);
      const double facing = glm::dot(in, push_);
      if (!known || gap >= 0.0 || facing < kStraight) continue;
      along += facing * facing;
      grip_at_ += facing * facing * shell_.positions[n];
      const Vec3 side = in - push_ * facing;
      flanks += glm::outerProduct(side, side);
    }
    if (along == 0.0) return;
    grip_at_ /= along;
    grip_start_ = pose_ * grip_at_;
    world_push_ = pose_.rotate(push_);
    grip_depth_ = glm::length(engaged_);
    flanks *= config_.flank_friction * config_.cutting_stiffness / (2.0 * along);
    // Principal axes by turning until the tensor is diagonal.
    Vec3 u = glm::normalize(glm::cross(push_, Vec3(0.31, 0.83, 0.46))), v = glm::cross(push_, u);
    for (int turn = 0; turn < 60; ++turn) {
      const double mixed = glm::dot(u, flanks * v), apart = glm::dot(u, flanks * u) - glm::dot(v, flanks * v);
      const double t = 0.5 * std::atan2(mixed, 0.5 * std::abs(apart) + 1e-30) * (apart < 0.0 ? -1.0 : 1.0);
      const Vec3 turned = u * std::cos(t) + v * std::sin(t);
      v = v * std::cos(t) - u * std::sin(t);
      u = turned;
    }
    for (const Vec3& axis : {u, v})
      if (const double k = glm::dot(axis, flanks * axis); k >= 1.0) grips_.push_back({pose_.rotate(axis), k});
  }

  /// The tool has gone further along the push than it was engaged: its flanks hold nothing any more.
  bool gone() const { return std::abs(glm::dot(pose_ * grip_at_ - grip_start_, world_push_)) > grip_depth_; }
  /// @param push_out [m] by which points that lie in what is cut are moved out in this look.
  void gather(bool spinning, double push_out) {
    std::map<std::size_t, double> before;
    for (const Touch& touch : touches_) before[touch.point] = touch.force;
    touches_.clear();
    const Vec3 moved = aside_ + pose_ * grip_at_ - grip_start_, aside = moved - world_push_ * glm::dot(moved, world_push_);
    for (std::size_t n = 0; n < grips_.size() && !gone(); ++n) {
      const std::size_t name = shell_.size() + n;
      Touch touch{name,
                  grips_[n].axis,
                  pose_.rotate(grip_at_),
                  Vec3(0.0),
                  glm::dot(grips_[n].axis, aside),
                  1.0 / grips_[n].stiffness,
                  before.contains(name) ? before[name] : 0.0,
                  false,
                  true};
      touch.lever = glm::cross(touch.arm, touch.normal);
      touches_.push_back(touch);
    }
    for (std::size_t n = 0; n < shell_.size(); ++n) {
      const bool cutting = spinning && shell_.cutting[n] != 0;
      const Vec3 local = cutting ? drawn_in(n) : shell_.positions[n];
      Touch touch{n, Vec3(0.0), pose_.rotate(local), Vec3(0.0), 0.0, 0.0, before.contains(n) ? before[n] : 0.0, cutting};
      const Vec3 at = pose_.translation + touch.arm + (cutting ? engaged_ : Vec3(0.0));
      if (!look_up(bone_, at, touch.gap, touch.normal) || touch.gap > kNear) continue;
      touch.gap *= edge_;
      touch.lever = glm::cross(touch.arm, touch.normal);
      touch.yield = cutting ? 0.0 : give_at(at - touch.normal * (touch.gap + 0.5 * edge_));
      // Bone that is cut holds what lies in it; a period pushes it out a little, once.
      if (cutting) touch.gap = std::max(touch.gap, -push_out - touch.yield * touch.force);
      touches_.push_back(touch);
    }
  }
  double give_at(const Vec3& p_bone) const {
    const Vec3 index = bone_.records.bone_from_index.inverse() * p_bone;
    const Vec3i v(glm::floor(index + 0.5));
    double hardness = 1.0;
    if (bone_.stiffness != nullptr && bone_.records.box.contains(v)) hardness = bone_.stiffness[bone_.records.box.offset_of(v)] / 255.0;
    return 1.0 / (config_.bone_stiffness * std::max(hardness, kSoftest));
  }
  /// One look, one solve, one move. @returns whether the tool rests.
  bool move(const Vec3& target, const Quat& turned, double k, double k_turn, bool spinning) {
    gather(spinning, looks_ == 0 ? config_.push_out / k : 0.0);
    const Vec3 free_t = target - pose_.translation, free_w = rotation_vector(turned * glm::conjugate(pose_.rotation));
    Vec3 t = free_t, w = free_w, e(0.0);
    const auto add = [&](const Touch& touch, double force) {
      t += touch.normal * (force / k);
      w += touch.lever * (force / k_turn);
      if (touch.cutting) e += touch.normal * (force * cutting_give_);
    };
    for (const Touch& touch : touches_) add(touch, touch.force);
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (Touch& touch : touches_) {
        const double give = 1.0 / k + glm::dot(touch.lever, touch.lever) / k_turn + (touch.cutting ? cutting_give_ : 0.0) + touch.yield;
        const double left = touch.gap + glm::dot(touch.normal, t) + glm::dot(touch.lever, w) +
                            (touch.cutting ? glm::dot(touch.normal, e - engaged_) : 0.0) + touch.yield * touch.force;
        const double free = touch.force - left / give, force = touch.spring ? free : std::max(0.0, free);
        if (force != touch.force) add(touch, force - touch.force);
        touch.force = force;
      }
    const double length = glm::length(t) + glm::length(w) * reach() + glm::length(e - engaged_);
    const double part = std::min(1.0, kStep * edge_ / std::max(length, 1e-12)) * (++looks_ > 8 ? 0.5 : 1.0);
    pose_ = {glm::normalize(turned_by(w * part) * pose_.rotation), pose_.translation + t * part};
    engaged_ += (e - engaged_) * part;
    return length < kRests * edge_;
  }
  double reach() const { return 5e-3; }  // [m] of the points that touch

  const ConstrainedToolConfig& config_;
  const PointShell& shell_;
  const SurfaceView& bone_;
  double edge_;
  Pose pose_;
  Vec3 engaged_;
  double cutting_give_;
  double play_ = 0.0;
  Vec3 push_{0.0};
  struct Grip {
    Vec3 axis;         // bone frame
    double stiffness;  // [N/m]
  };
  std::vector<Grip> grips_;
  Vec3 aside_{0.0}, world_push_{0.0}, grip_at_{0.0}, grip_start_{0.0};
  std::vector<Touch> touches_;
  int looks_ = 0;
  double to_cut_ = 0.0, grip_depth_ = 0.0;
};

}  // namespace

TwinForce feel_plainly(const ConstrainedToolConfig& config, const PointShell& shell, const SurfaceView& bone, const TwinStart& start,
                       const HandMotion& hand, double dt, bool spinning) {
  return Plain(config, shell, bone, start).run(hand, start, dt, spinning);
}

}  // namespace burrhole::test
