#include "volumes/phantom/head_shape.h"

#include <algorithm>
#include <cmath>

#include "core/base/portable_math.h"
#include "volumes/phantom/head_solids.h"

namespace burrhole {

using namespace head_solids;

Solid head_solids::vault_of(const Vec3& p) noexcept {
  const Fold fold(p);
  Solid v = ellipsoid(p - Vec3(0, -6, 45), {69, 84, 68});
  v = unite(v, ellipsoid(p - Vec3(0, -40, 44), {58, 56, 56}), 24);               // forehead
  v = unite(v, fold(ellipsoid(fold.q - Vec3(24, 20, 56), {46, 44, 46})), 24);    // parietal eminences
  v = unite(v, ellipsoid(p - Vec3(0, 42, 32), {54, 40, 46}), 24);                // back of the head
  v = unite(v, fold(ellipsoid(fold.q - Vec3(40, 6, 22), {27, 42, 32})), 16);     // temporal bones
  return cut(v, fold(ellipsoid(fold.q - Vec3(78, -54, 14), {17, 24, 25})), 14);  // temporal fossae
}

namespace {

// All lengths in this file are in mm. Parts on both sides are given for the left one and used with |x|.

/// Sutures as wavy grooves: coronal, sagittal and lambdoid. Bregma and lambda are where they meet.
constexpr double kBregma = -26.0, kLambda = 62.0;  // y

/// @returns the depth of a groove at a distance from its mean line. The waves of 9 and 4 mm and their amplitudes are assumed.
double groove(double off, double along) noexcept {
  constexpr double kDepth = 1.0, kWidth = 0.75, kFar = 1.7 + 4.0 * kWidth;
  if (std::abs(off) > kFar) return 0.0;
  const double x = off + 1.1 * portable_sin(0.70 * along) + 0.6 * portable_sin(1.63 * along + 1.0);
  return kDepth * portable_exp(-0.5 * x * x / (kWidth * kWidth));
}

double sutures(const Vec3& p) noexcept {
  const Vec3 q = Fold(p).q;
  double deepest = 0.0;
  // From bregma down and forwards to the temple.
  if (q.z > 22.0)
    deepest = smooth_step(22.0, 34.0, q.z) * groove((q.y - kBregma + 0.26 * (112.0 - q.z)) / 1.033, q.x + 0.8 * (112.0 - q.z));
  if (q.z > 60.0) {
    const double between = smooth_step(kBregma - 1.0, kBregma + 1.0, q.y) * (1.0 - smooth_step(kLambda - 1.0, kLambda + 1.0, q.y));
    deepest = std::max(deepest, between * groove(p.x, q.y));
  }
  // From lambda down and forwards to behind the ear.
  if (q.y > 15.0 && q.z > 8.0)
    deepest = std::max(deepest, smooth_step(8.0, 16.0, q.z) * groove((q.z - 84.0 + 1.35 * q.x) / 1.68, q.x - 0.74 * q.z));
  return deepest;
}

Solid eye_socket(const Fold& fold) noexcept { return fold(cone(fold.q, {33, -106, 13}, {17, -52, 17}, 21, 4)); }
Solid nose_hole(const Vec3& p) noexcept {
  return unite(ellipsoid(p - Vec3(0, -102, -15), {12.5, 24, 12}), ellipsoid(p - Vec3(0, -104, -3), {6.5, 17, 15}), 5);
}

/// A row of teeth along an arch: ridges with gaps between them, where from < z < to.
Solid teeth(Solid arch, const Vec3& p, double from, double to) noexcept {
  if (arch.v > 6.0 || p.z < from - 4.0 || p.z > to + 4.0 || p.y > -58.0) return arch;
  const double angle = portable_atan2(p.x, -(p.y + 70.0));
  const double between = 1.0 - std::abs(portable_sin(8.5 * angle));
  const double share = smooth_step(from - 3.0, from, p.z) * (1.0 - smooth_step(to, to + 3.0, p.z));
  arch.v += 1.6 * share * between * between * between;
  return arch;
}

/// On the left: cheekbone, the rims of the eye socket, and the arch to the ear.
Solid cheek(const Vec3& q) noexcept {
  Solid v = cone(q, {51, -80, 27}, {51, -79, 0}, 5.0, 6.5);
  v = unite(v, ellipsoid(q - Vec3(46, -80, -13), {16, 12, 13}), 8);
  v = unite(v, cone(q, {14, -95, -2}, {44, -88, -8}, 6.0, 7.0), 7);
  v = unite(v, cone(q, {56, -70, -12}, {67, -40, -5}, 6.0, 4.5), 8);
  return unite(v, cone(q, {67, -40, -5}, {66, -10, 0}, 4.5, 5.0), 6);
}

Solid upper_face(const Vec3& p) noexcept {
  const Fold fold(p);
  const Vec3& q = fold.q;
  Solid v = fold(unite(cone(q, {5, -96, 28}, {30, -95, 36}, 7, 7), cone(q, {30, -95, 36}, {51, -79, 26}, 7, 6), 8));
  v = unite(v, fold(cheek(q)), 8);
  v = unite(v, ellipsoid(p - Vec3(0, -70, -24), {36, 27, 27}), 12);
  v = unite(v, teeth(ellipsoid(p - Vec3(0, -72, -52), {28, 32, 24}), p, -66, -51), 8);
  v = unite(v, cone(p, {0, -95, 24}, {0, -107, 3}, 6.5, 4.5), 9);
  return unite(v, fold(cone(q, {8, -98, 12}, {19, -92, -14}, 5.5, 6.0)), 7);
}

Solid lower_jaw(const Vec3& p) noexcept {
  const Fold fold(p);
  const Vec3& q = fold.q;
  Solid v = unite(ellipsoid(p - Vec3(0, -88, -93), {22, 12, 12}), fold(cone(q, {14, -89, -91}, {47, -34, -72}, 11, 9)), 12);
  v = unite(v, teeth(ellipsoid(p - Vec3(0, -72, -72), {27, 31, 22}), p, -73, -56), 10);
  // The ramus is flat.
  constexpr double kFlat = 1.6;
  const Vec3 flat(kFlat * (q.x - 49.0), q.y, q.z);
  Solid ramus = cone(flat, {0, -32, -70}, {7, -9, -9}, 13, 8);
  ramus = unite(ramus, cone(flat, {0, -42, -66}, {0, -38, -16}, 12, 6), 12);
  ramus = {ramus.v / kFlat, Vec3(ramus.n.x, ramus.n.y / kFlat, ramus.n.z / kFlat)};
  return unite(v, fold(ramus), 8);
}

Solid face_of(const Vec3& p) noexcept {
  const Fold fold(p);
  Solid v = unite(upper_face(p), lower_jaw(p), 1.0);
  const double above = p.z + 61.5;
  if (p.y < -48.0 && std::abs(above) < 12.0) v = cut(v, {std::abs(above) - 0.8, Vec3(0, 0, above < 0.0 ? -1 : 1)}, 1.5);  // the bite
  v = cut(v, ellipsoid(p - Vec3(0, -58, -66), {19, 32, 29}), 6);                                                          // mouth
  return unite(v, fold(ellipsoid(fold.q - Vec3(49, 14, -12), {10, 13, 15})), 14);  // mastoid processes
}

/// @returns a lower bound of the distance from all parts but the vault and the inion.
double face_distance(const Vec3& p) noexcept {
  const Vec3 lo(-74, -116, -108), hi(74, 44, 46);
  const Vec3 off = glm::max(glm::max(lo - p, p - hi), Vec3(0.0));
  return std::sqrt(glm::dot(off, off));
}

/// Ellipsoids around the vault, the face with its cheekbones and the lower jaw; their convex hull holds the skull, by a test.
struct Around {
  Vec3 centre, radii;
};
constexpr Around kAround[] = {
    {{0, -6, 42}, {87, 104, 88}}, {{0, -48, 0}, {80, 76, 60}}, {{0, -56, -52}, {72, 68, 65}}, {{0, -72, -74}, {54, 52, 38}}};

HeadField in_metres(const Solid& s) noexcept { return {1e-3 * s.v, s.n}; }

}  // namespace

HeadField HeadShape::vault(const Vec3& p) noexcept { return in_metres(vault_of(1e3 * p)); }

HeadFields HeadShape::at(const Vec3& p) const noexcept {
  const Vec3 mm = 1e3 * p;
  const Solid vault = vault_of(mm);
  Solid v = vault, outer = vault, cavity = grown(vault, -thickness_);
  if (std::abs(v.v) < 6.0) v.v += sutures(mm);
  constexpr double kBlend = 10.0;
  if (face_distance(mm) < std::max(v.v, 0.0) + kBlend) {
    const Fold fold(mm);
    const Solid eyes = eye_socket(fold), nose = nose_hole(mm);
    v = unite(v, face_of(mm), kBlend);
    v = cut(v, eyes, 3);
    v = cut(v, nose, 2);
    v = cut(v, fold(cone(fold.q, {80, 0, 0}, {46, 3, 2}, 4.5, 4.0)), 2);  // ear canals
    v = cut(v, cone(mm, {0, 24, -60}, {0, 24, 0}, 16, 16), 4);            // foramen magnum
    constexpr double kWall = 3.5;                                         // of eye sockets and nose
    outer = cut(cut(outer, eyes, 3), nose, 3);
    cavity = cut(cut(cavity, grown(eyes, kWall), 4), grown(nose, kWall), 4);
  }
  if (mm.y > 55.0) v = unite(v, ellipsoid(mm - Vec3(0, 77, 9), {12, 6, 6}), 10);  // inion
  if (-cavity.v > v.v) v = inverted(cavity);
  return {in_metres(v), in_metres(cavity), 1e-3 * outer.v};
}

double HeadShape::hull(const Vec3& p) noexcept {
  const Vec3 mm = 1e3 * p;
  const auto part = [&](const Around& e) { return ellipsoid(mm - e.centre, e.radii); };
  return 1e-3 * unite(unite(unite(part(kAround[0]), part(kAround[1]), 30), part(kAround[2]), 30), part(kAround[3]), 30).v;
}

double HeadShape::reach(const Vec3& direction) noexcept {
  double most = 0.0;
  for (const Around& e : kAround) most = std::max(most, glm::dot(e.centre, direction) + glm::length(e.radii * direction));
  return 1e-3 * most;
}

}  // namespace burrhole
