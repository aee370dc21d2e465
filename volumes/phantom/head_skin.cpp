// The skin of a head: all lengths in mm. Parts on both sides are given for the left one and used with |x|.
#include "core/base/portable_math.h"
#include "volumes/phantom/head_shape.h"
#include "volumes/phantom/head_solids.h"

namespace burrhole {

using namespace head_solids;

namespace {

/// Of scalp over the vault: assumed, within the 4 to 7 mm of adults.
constexpr double kScalp = 5.5;

/// Vault with its scalp, temples filled by muscle, and the mass of face, cheeks and jaw.
Solid without_features(const Vec3& p, const Fold& fold) noexcept {
  const Vec3& q = fold.q;
  Solid v = grown(vault_of(p), kScalp);
  v = unite(v, fold(ellipsoid(q - Vec3(46, -48, 6), {29, 44, 46})), 26);    // temples
  v = unite(v, ellipsoid(p - Vec3(0, -46, -28), {66, 58, 76}), 18);         // face
  v = unite(v, fold(ellipsoid(q - Vec3(36, -78, -20), {27, 24, 32})), 16);  // cheeks
  v = unite(v, fold(ellipsoid(q - Vec3(48, -30, -56), {15, 34, 26})), 22);  // angles of the jaw
  v = unite(v, ellipsoid(p - Vec3(0, -78, -60), {40, 32, 32}), 18);         // mouth
  v = unite(v, ellipsoid(p - Vec3(0, -90, -93), {25, 19, 17}), 14);         // chin
  v = unite(v, fold(cone(q, {14, -88, -91}, {47, -34, -72}, 15, 14)), 14);  // lower jaw
  v = unite(v, fold(ellipsoid(q - Vec3(50, 15, -9), {14, 19, 21})), 14);    // mastoid processes
  v = unite(v, ellipsoid(p - Vec3(0, 76, 9), {19, 12, 13}), 16);            // inion
  return unite(v, cone(p, {0, 6, -30}, {0, 22, -132}, 52, 54), 26);         // neck
}

/// Brows, and closed lids over the eyes in their hollows.
Solid with_eyes(Solid v, const Vec3& p, const Fold& fold) noexcept {
  const Vec3& q = fold.q;
  v = unite(v, fold(cone(q, {6, -97, 29}, {30, -96, 36}, 9.5, 9.5)), 18);
  v = unite(v, fold(cone(q, {30, -96, 36}, {52, -79, 26}, 9.5, 9.0)), 18);
  v = unite(v, ellipsoid(p - Vec3(0, -95, 26), {15, 12, 13}), 14);  // between the brows
  v = cut(v, fold(ellipsoid(q - Vec3(32, -112, 14), {17, 17, 11})), 10);
  return unite(v, fold(ellipsoid(q - Vec3(32, -90, 13), {14.5, 14, 12})), 4);
}

Solid with_nose(Solid v, const Vec3& p, const Fold& fold) noexcept {
  const Vec3& q = fold.q;
  // Beside the nose.
  v = unite(v, fold(unite(cone(q, {8, -98, 12}, {19, -93, -14}, 8.5, 9.0), cone(q, {14, -95, -2}, {44, -88, -8}, 8.5, 9.5), 6)), 9);
  Solid nose = unite(cone(p, {0, -102, 24}, {0, -123, -10}, 6.5, 8.0), ellipsoid(p - Vec3(0, -124, -15), {9.5, 9.5, 8.5}), 7);
  nose = unite(nose, fold(ellipsoid(q - Vec3(11, -114, -18), {7, 10, 7.5})), 5);
  nose = unite(nose, ellipsoid(p - Vec3(0, -108, -16), {15, 14, 9}), 8);
  nose = cut(nose, fold(ellipsoid(q - Vec3(6, -117, -26), {3.2, 5.5, 5})), 2);  // nostrils
  return unite(v, nose, 7);
}

Solid with_mouth(Solid v, const Vec3& p) noexcept {
  v = unite(v, ellipsoid(p - Vec3(0, -104, -47), {25, 9.5, 7.5}), 7);
  v = unite(v, ellipsoid(p - Vec3(0, -103, -62), {22, 9.5, 7}), 6);
  // Between the lips, from corner to corner.
  return cut(v, ellipsoid(p - Vec3(0, -114, -54.5), {26, 7.5, 1.8}), 3);
}

/// The pinna: a tilted disc with a hollow, behind the ear canal.
Solid ear(const Vec3& q) noexcept {
  // Its plane opens to the back by 25 degrees and leans to the back by 15.
  constexpr double kOut = 0.436, kLean = 0.26;
  const Vec3 d = q - Vec3(73, 6, 2);
  const double c = portable_cos(kOut), s = portable_sin(kOut), cl = portable_cos(kLean), sl = portable_sin(kLean);
  const Vec3 a(c * d.x - s * d.y, s * d.x + c * d.y, d.z);          // x across the disc
  const Vec3 local(a.x, cl * a.y - sl * a.z, sl * a.y + cl * a.z);  // y to the back, z up
  Solid v = ellipsoid(local - Vec3(6, 9, 4), {6.5, 17, 30});
  v = unite(v, ellipsoid(local - Vec3(4, 3, -22), {5, 9, 10}), 6);
  v = cut(v, ellipsoid(local - Vec3(13, 8, 6), {6.5, 12, 22}), 4);
  const Vec3 b(v.n.x, cl * v.n.y + sl * v.n.z, -sl * v.n.y + cl * v.n.z);
  v.n = Vec3(c * b.x + s * b.y, -s * b.x + c * b.y, b.z);
  return v;
}

constexpr double kNeckEnd = -132.0;

Solid skin_of(const Vec3& p) noexcept {
  const Fold fold(p);
  Solid v = without_features(p, fold);
  if (p.y < -45.0) v = with_mouth(with_nose(with_eyes(v, p, fold), p, fold), p);
  if (fold.q.x > 45.0 && p.y > -40.0 && p.y < 60.0 && std::abs(p.z) < 60.0) v = unite(v, fold(ear(fold.q)), 5);
  // The neck ends in a plane.
  return cut(v, {p.z - kNeckEnd, Vec3(0, 0, 1)}, 10);
}

}  // namespace

double HeadShape::skin(const Vec3& p) noexcept { return 1e-3 * skin_of(1e3 * p).v; }

Bounds HeadShape::skin_box() noexcept { return {1e-3 * Vec3(-108, -142, -138), 1e-3 * Vec3(108, 104, 128)}; }

}  // namespace burrhole
