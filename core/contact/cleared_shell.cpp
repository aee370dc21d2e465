// The scalar reference is cleared(), point by point.
#include "core/contact/cleared_shell.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/cleared_shell.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef BURRHOLE_DRAWN_SHELL_ONCE
#define BURRHOLE_DRAWN_SHELL_ONCE
namespace burrhole {

struct DrawJob {
  std::array<const double*, 3> position, inward;
  std::array<float*, 3> out;
  double push[3], middle[3], clearance;
  std::size_t count;  // a multiple of kShellPad
};

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

void Draw(const DrawJob& job) {
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<float, decltype(d)> df;
  using V = hn::Vec<decltype(d)>;
  const V px = hn::Set(d, job.push[0]), py = hn::Set(d, job.push[1]), pz = hn::Set(d, job.push[2]), clearance = hn::Set(d, job.clearance);
  for (std::size_t n = 0; n < job.count; n += hn::Lanes(d)) {
    const V x = hn::LoadU(d, job.inward[0] + n), y = hn::LoadU(d, job.inward[1] + n), z = hn::LoadU(d, job.inward[2] + n);
    const V along = hn::Add(hn::Add(hn::Mul(x, px), hn::Mul(y, py)), hn::Mul(z, pz));
    const V part = hn::Mul(hn::Sub(hn::Set(d, kClearedBelow), hn::Mul(along, along)), hn::Set(d, kClearedRise));
    const V by = hn::Mul(clearance, hn::Clamp(part, hn::Zero(d), hn::Set(d, 1.0)));
    const auto draw = [&](std::size_t axis, V inward, V push) HWY_ATTR {
      const V way = hn::Mul(hn::Sub(inward, hn::Mul(push, along)), by);
      const V to = hn::Sub(hn::Add(hn::LoadU(d, job.position[axis] + n), way), hn::Set(d, job.middle[axis]));
      hn::StoreU(hn::DemoteTo(df, to), df, job.out[axis] + n);
    };
    draw(0, x, px);
    draw(1, y, py);
    draw(2, z, pz);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
namespace {
HWY_EXPORT(Draw);
}  // namespace

ClearedShell::ClearedShell(const PointShell& shell, const ContactShellPart& part, const Vec3& middle) : middle_(middle) {
  for (std::size_t n = 0; n < part.x.size(); ++n) {
    const std::uint32_t point = part.point[std::min(n, part.size() - 1)];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      position_[axis].push_back(shell.positions[point][axis]);
      inward_[axis].push_back(shell.inward_normals[point][axis]);
    }
  }
}

void ClearedShell::draw(const Vec3& push, double clearance, ContactShellPart& part) const noexcept {
  DrawJob job{.position = {position_[0].data(), position_[1].data(), position_[2].data()},
              .inward = {inward_[0].data(), inward_[1].data(), inward_[2].data()},
              .out = {part.x.data(), part.y.data(), part.z.data()},
              .push = {push.x, push.y, push.z},
              .middle = {middle_.x, middle_.y, middle_.z},
              .clearance = clearance,
              .count = part.x.size()};
  HWY_DYNAMIC_DISPATCH(Draw)(job);
}

}  // namespace burrhole
#endif
