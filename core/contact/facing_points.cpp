// The scalar reference is in tests/core/contact/facing_points_test.cpp.
#include "core/contact/facing_points.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/facing_points.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/contact/probe_lanes-inl.h"

#ifndef BURRHOLE_FACING_POINTS_ONCE
#define BURRHOLE_FACING_POINTS_ONCE
namespace burrhole {

struct FacingJob {
  std::array<const float*, 3> inward, place;
  const std::uint32_t* point;
  std::array<float*, 3> out_place;
  std::uint32_t* out_point;
  float push[3], least;
  std::size_t count;  // points; arrays are padded
};

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

std::size_t Pick(const FacingJob& job) {
  const Floats df;
  const Ints di;
  const Vf px = hn::Set(df, job.push[0]), py = hn::Set(df, job.push[1]), pz = hn::Set(df, job.push[2]), least = hn::Set(df, job.least);
  std::size_t kept = 0;
  for (std::size_t n = 0; n < job.count; n += hn::Lanes(df)) {
    const auto inward = [&](std::size_t axis) HWY_ATTR { return hn::LoadU(df, job.inward[axis] + n); };
    const Vf along = hn::Add(hn::Add(hn::Mul(inward(0), px), hn::Mul(inward(1), py)), hn::Mul(inward(2), pz));
    const auto facing = hn::And(hn::Ge(along, least), hn::FirstN(df, job.count - n));
    if (hn::AllFalse(df, facing)) continue;
    const Vi name = hn::LoadU(di, reinterpret_cast<const std::int32_t*>(job.point) + n);
    keep_lanes(facing, [&](auto keep) HWY_ATTR {
      for (std::size_t axis = 0; axis < 3; ++axis) keep(hn::LoadU(df, job.place[axis] + n), df, job.out_place[axis] + kept);
      keep(name, di, reinterpret_cast<std::int32_t*>(job.out_point) + kept);
    });
    kept += hn::CountTrue(df, facing);
  }
  return kept;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
namespace {

HWY_EXPORT(Pick);

// Rounding bound of a sum of three products of unit vectors in single precision: 4 roundings of 6e-8, and those of the vectors. Below 1e-6.
constexpr double kRounding = 5e-6;

}  // namespace

FacingPoints::FacingPoints(const PointShell& shell, const ContactShellPart& part) {
  for (std::size_t n = 0; n < part.x.size(); ++n) {
    const std::uint32_t point = part.point[std::min(n, part.size() - 1)];
    for (std::size_t axis = 0; axis < 3; ++axis) inward_[axis].push_back(static_cast<float>(shell.inward_normals[point][axis]));
    point_.push_back(point);
  }
  // Vector stores may write up to one vector beyond the kept elements.
  for (auto* axis : {&facing_.x, &facing_.y, &facing_.z}) axis->assign(part.x.size() + kShellPad, 0.0f);
  facing_.point.assign(part.x.size() + kShellPad, 0);
}

const ContactShellPart& FacingPoints::pick(const ContactShellPart& part, const Vec3& push, double least) noexcept {
  facing_.point.resize(part.x.size() + kShellPad);  // its initial size: no allocation
  const FacingJob job{.inward = {inward_[0].data(), inward_[1].data(), inward_[2].data()},
                      .place = {part.x.data(), part.y.data(), part.z.data()},
                      .point = point_.data(),
                      .out_place = {facing_.x.data(), facing_.y.data(), facing_.z.data()},
                      .out_point = facing_.point.data(),
                      .push = {static_cast<float>(push.x), static_cast<float>(push.y), static_cast<float>(push.z)},
                      .least = static_cast<float>(least - kRounding),
                      .count = part.size()};
  facing_.point.resize(HWY_DYNAMIC_DISPATCH(Pick)(job));
  return facing_;
}

}  // namespace burrhole
#endif
