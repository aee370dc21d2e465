/// core/base/rotation.h: conversion between unit quaternions and rotation vectors (axis times angle); same bits on every x86-64 CPU.
///   Frame  any.   Units  rad.   Thread  any.
#pragma once

#include "core/base/geometry.h"

namespace burrhole {

/// @returns the rotation vector of a unit quaternion. Of the two equivalent angles it is the smaller one, at most pi.
[[nodiscard]] Vec3 rotation_vector(const Quat& q) noexcept;
/// @returns the unit quaternion of a rotation vector. A vector longer than 1e6 rad is shortened to 1e6 rad: beyond that the angle has no
/// significant digits.
[[nodiscard]] Quat rotation_of(const Vec3& vector) noexcept;

}  // namespace burrhole
