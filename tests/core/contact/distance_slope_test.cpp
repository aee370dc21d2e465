// distance_slope against the closed form of the phantoms, beside the normals that the records hold.
#include "core/contact/distance_slope.h"

#include <cstdio>

#include "shipped_bone.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

struct Angles {
  std::vector<double> slope, stored;  ///< [degrees] off the truth
};

double at_share(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// At places within 0.3 voxel of the surface, more than `off_edge` [m] from x = 0.
Angles angles(const PhantomSpec& spec, double across, double off_edge) {
  const Phantom phantom = phantom_of(spec);
  const ShippedBone bone(phantom);
  Angles out;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    const Vec3 start = across * (random_vector(11, n) - Vec3(0.0, 0.0, 1.0));
    const SurfaceDistance first = phantom.truth.nearest(start);
    const Vec3 p = start - first.normal * (first.signed_distance + 0.3 * spec.pitch * uniform11(12, n));
    const SurfaceDistance near = phantom.truth.nearest(p);
    if (p.z < -1.5 * across || std::abs(p.x) < off_edge || glm::dot(near.normal, first.normal) < 0.99) continue;
    const Vec3 index = phantom.bone.bone_from_index.inverse() * p;
    const auto slope = distance_slope(bone.view().records, index);
    const auto sample = sample_records(bone.view().records, index);
    REQUIRE(slope);
    REQUIRE(sample);
    out.slope.push_back(degrees_between(*slope, near.normal));
    out.stored.push_back(degrees_between(sample->normal, near.normal));
  }
  return out;
}

}  // namespace

TEST_CASE("distance slope: steadier than the normals stored, on planes, balls and near an edge") {
  PhantomSpec spec;
  spec.pitch = 0.25e-3;
  spec.extent = Vec3(0.010, 0.010, 0.009);
  spec.above = 0.002;
  spec.thickness = 0.005;
  struct Case {
    std::string name;
    PhantomSpec spec;
    double off_edge, median, largest;
  };
  std::vector<Case> cases;
  const auto add = [&](const std::string& name, PhantomKind kind, double off_edge, double median, double largest) {
    cases.push_back({name, spec, off_edge, median, largest});
    cases.back().spec.kind = kind;
    return &cases.back().spec;
  };
  add("level plate", PhantomKind::plate, 0.0, 0.01, 0.01);
  add("tilted plate", PhantomKind::plate, 0.0, 0.05, 0.15)->plate_normal = Vec3(0.37, -0.22, 1.0);
  add("ball of 20 voxels", PhantomKind::sphere, 0.0, 0.3, 0.6)->sphere_radius = 5e-3;
  add("wedge, 2 voxels from its edge", PhantomKind::wedge, 2.0 * 0.25e-3 * std::sqrt(0.5), 0.05, 0.5);
  std::printf("direction off the truth [degrees]: slope of distances, then normals stored: median, 99 in 100, largest\n");
  for (const Case& one : cases) {
    CAPTURE(one.name);
    const Angles off = angles(one.spec, 2e-3, one.off_edge);
    REQUIRE(off.slope.size() > 100);
    std::printf("%-32s %6.3f %6.3f %6.3f   %6.3f %6.3f %6.3f\n", one.name.c_str(), at_share(off.slope, 0.5), at_share(off.slope, 0.99),
                at_share(off.slope, 1.0), at_share(off.stored, 0.5), at_share(off.stored, 0.99), at_share(off.stored, 1.0));
    CHECK(at_share(off.slope, 0.5) <= one.median);
    CHECK(at_share(off.slope, 1.0) <= one.largest);
  }
}
