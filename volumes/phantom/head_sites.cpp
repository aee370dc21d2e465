#include "volumes/phantom/head_sites.h"

#include <algorithm>
#include <cmath>

#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kMm = kMillimetre;

/// By central differences: the slope of a field is not its gradient where parts blend.
Vec3 vault_normal(const Vec3& p) {
  constexpr double kStep = 1e-5;  // [m]
  const auto slope = [&](const Vec3& d) { return HeadShape::vault(p + kStep * d).value - HeadShape::vault(p - kStep * d).value; };
  return glm::normalize(Vec3(slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})));
}

/// Moves a point near the vault onto it, along its gradient. Newton's steps: each squares an error, and one of a millimetre is small.
Vec3 on_vault(Vec3 p) {
  for (int step = 0; step < 4; ++step) {
    const HeadField f = HeadShape::vault(p);
    p -= f.slope * (f.value / glm::dot(f.slope, f.slope));
  }
  return p;
}

/// The point where a ray from inside leaves the vault.
Vec3 seen_from(const Vec3& inside, const Vec3& way) {
  double lo = 0.0, hi = 0.15;
  for (int n = 0; n < 50; ++n) {
    const double middle = 0.5 * (lo + hi);
    (HeadShape::vault(inside + middle * way).value < 0.0 ? lo : hi) = middle;
  }
  return inside + lo * way;
}

constexpr Vec3 kForward{0.0, -1.0, 0.0}, kBack{0.0, 1.0, 0.0}, kUp{0.0, 0.0, 1.0};

/// A site on the right is the mirror image of that on the left, as the head is symmetric.
struct SideRule {
  const char* name;
  Vec3 (*left)();
};

Vec3 nasion() { return seen_from(Vec3(0.0, 0.0, 27.0) * kMm, kForward); }
Vec3 inion() { return seen_from(Vec3(0.0, 0.0, 8.0) * kMm, kBack); }
Vec3 bregma() { return seen_from(Vec3(0.0, -26.0, 45.0) * kMm, kUp); }
Vec3 lambda() { return seen_from(Vec3(0.0, 0.0, 45.0) * kMm, glm::normalize(Vec3(0.0, 62.0, 39.0))); }
Vec3 vertex() {
  // The highest point of the midline, to half a millimetre.
  Vec3 best = bregma();
  for (int half_mm = -60; half_mm <= 80; ++half_mm) {
    const Vec3 p = seen_from(Vec3(0.0, 0.5 * half_mm, 45.0) * kMm, kUp);
    if (p.z > best.z) best = p;
  }
  return best;
}
Vec3 ear() { return seen_from(Vec3(0.0, 0.0, 3.0) * kMm, {1.0, 0.0, 0.0}); }

Vec3 side_of(const Vec3& midline, double lateral) { return walk_on_vault(midline, {1.0, 0.0, 0.0}, lateral); }

/// Kocher's point: 11 cm back from the nasion along the midline, which is about 1 cm in front of the coronal suture, and 3 cm to the side
/// (2.5 to 3 in textbooks of neurosurgery).
Vec3 kocher() { return side_of(walk_on_vault(nasion(), kUp, 110.0 * kMm), 30.0 * kMm); }
/// Keen's point: 3 cm above and 3 cm behind the pinna (2.5 to 3 in textbooks). The top of the pinna is assumed 3 cm above the ear canal, its
/// back edge 2 cm behind it.
Vec3 keen() {
  const Vec3 above = walk_on_vault(ear(), kUp, 60.0 * kMm);
  return walk_on_vault(above, kBack, 50.0 * kMm);
}
/// Frazier's point: 6 cm above the inion along the midline and 4 cm to the side (6 to 7 and 3 to 4 in textbooks).
Vec3 frazier() { return side_of(walk_on_vault(inion(), kUp, 60.0 * kMm), 40.0 * kMm); }
/// Dandy's point: 3 cm above the inion and 2 cm to the side.
Vec3 dandy() { return side_of(walk_on_vault(inion(), kUp, 30.0 * kMm), 20.0 * kMm); }
/// The parietal eminence, a usual site for a chronic subdural haematoma: assumed 7.5 cm from the midline, half way between bregma and lambda.
Vec3 parietal() {
  const Vec3 from = bregma(), to = lambda();
  return side_of(on_vault(seen_from(Vec3(0.0, 0.0, 45.0) * kMm, glm::normalize(0.5 * (from + to) - Vec3(0.0, 0.0, 45.0) * kMm))),
                 75.0 * kMm);
}
/// The pterion: about 4 cm above the middle of the zygomatic arch, and as far forward as that (3.8 cm in front of the ear canal: assumed).
Vec3 pterion() {
  const Vec3 below = on_vault(seen_from(Vec3(0.0, -38.0, 12.0) * kMm, {1.0, 0.0, 0.0}));
  return walk_on_vault(below, kUp, 32.0 * kMm);
}

constexpr SideRule kSites[] = {{"kocher", kocher}, {"keen", keen},         {"frazier", frazier},
                               {"dandy", dandy},   {"parietal", parietal}, {"pterion", pterion}};

HeadSite make_site(std::string name, const Vec3& p) { return {std::move(name), p, vault_normal(p)}; }

Vec3 mirrored(const Vec3& p) { return {-p.x, p.y, p.z}; }

}  // namespace

Vec3 walk_on_vault(const Vec3& from, const Vec3& way, double length) {
  const Vec3 up = vault_normal(from);
  const Vec3 across = glm::normalize(glm::cross(up, way));  // normal of the plane of the walk
  constexpr double kStep = 0.25 * kMillimetre;
  Vec3 p = from;
  double walked = 0.0;
  while (walked < length) {
    const double step = std::min(kStep, length - walked);
    const Vec3 along = glm::normalize(glm::cross(across, vault_normal(p)));
    Vec3 next = on_vault(p + step * along);
    next -= across * glm::dot(across, next - from);
    walked += step;
    p = next;
  }
  return p;
}

std::vector<HeadSite> head_landmarks() {
  const Vec3 left = ear();
  std::vector<HeadSite> out{make_site("nasion", nasion()),         make_site("inion", inion()),   make_site("vertex", vertex()),
                            make_site("bregma", bregma()),         make_site("lambda", lambda()), make_site("ear_left", left),
                            make_site("ear_right", mirrored(left))};
  return out;
}

std::vector<std::string> head_site_names() {
  std::vector<std::string> out;
  for (const SideRule& rule : kSites)
    for (const char* side : {"_left", "_right"}) out.push_back(std::string(rule.name) + side);
  return out;
}

std::optional<HeadSite> find_head_site(std::string_view name) {
  for (const SideRule& rule : kSites)
    for (const bool left : {true, false}) {
      const std::string full = std::string(rule.name) + (left ? "_left" : "_right");
      if (full != name) continue;
      HeadSite site = make_site(full, rule.left());
      if (left) return site;
      return HeadSite{full, mirrored(site.point), mirrored(site.normal)};
    }
  return std::nullopt;
}

std::vector<HeadSite> head_sites() {
  std::vector<HeadSite> out;
  for (const std::string& name : head_site_names()) out.push_back(*find_head_site(name));
  return out;
}

}  // namespace burrhole
