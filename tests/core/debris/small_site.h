/// tests/core/debris/small_site.h: a site of 8 x 8 x 8 mm round the origin, whose bone is a function of the place.
#pragma once

#include <doctest/doctest.h>

#include <vector>

#include "core/debris/debris_site.h"

namespace burrhole::test {

inline DebrisSite make_site(const Affine& bone_from_index, const Vec3& down = Vec3(0.0, 0.0, -1.0), double cell = 0.5e-3,
                            double half = 4e-3) {
  auto site = DebrisSite::create({Vec3(-half), Vec3(half)}, bone_from_index, {Vec3i(0), Vec3i(41)}, cell, down);
  REQUIRE(site);
  return std::move(*site);
}

template <class F>
void fill(DebrisSite& site, const F& density) {
  std::vector<float> values;
  for_each_voxel(site.voxels(), [&](const Vec3i& v) { values.push_back(static_cast<float>(density(site.place_of(v)))); });
  site.set_bone(site.voxels(), values);
}

}  // namespace burrhole::test
