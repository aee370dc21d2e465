#include "app/view/debris_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/random.h"

namespace burrhole {
namespace {

constexpr glm::vec3 kChipColor(0.97f, 0.91f, 0.78f), kMistColor(0.96f, 0.93f, 0.88f);  // fresh bone meal, drier and whiter when fine
constexpr float kDarkest = 0.85f;                                                      // [-] of the colour, of the darkest flake
constexpr std::uint8_t kMoist = 40;                                                    // shine of chips
constexpr float kFlat = 0.35f;          // [-] thickness of a flake over its width, before its volume is set
constexpr float kUneven = 0.45f;        // [-] of a corner's distance, by which corners are moved
constexpr float kResting = 0.5f;        // [-] of its ball, by which a settled particle's flakes lie above its place
constexpr float kMistSpread = 1.5e-3f;  // [m]
constexpr float kMistVolume = 0.02f;    // [-] of a mist particle's volume that is drawn
constexpr std::size_t kMistFlakes = 6;
constexpr std::array<glm::vec3, 4> kCorners{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
constexpr std::array<std::array<std::uint32_t, 3>, 4> kFaces{{{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};

/// Random numbers of one flake.
class Dice {
 public:
  Dice(std::uint32_t particle, std::size_t flake) : seed_(particle), count_(flake << 8) {}
  float operator()() { return static_cast<float>(uniform11(seed_, count_++)); }
  glm::vec3 in_ball() {
    for (int n = 0; n < 8; ++n) {
      const float x = (*this)(), y = (*this)(), z = (*this)();
      if (x * x + y * y + z * z <= 1.0f) return {x, y, z};
    }
    return glm::vec3(0.0f);
  }

 private:
  std::uint64_t seed_, count_;
};

std::uint8_t code(float value) { return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f))); }

void append_flake(const glm::vec3& centre, float volume, const glm::vec3& color, Dice& dice, AddedMesh& out) {
  std::array<glm::vec3, 4> corner = kCorners;
  for (glm::vec3& one : corner) one += kUneven * glm::vec3(dice(), dice(), dice());
  for (glm::vec3& one : corner) one.z *= kFlat;
  const float a = dice(), b = dice(), c = dice(), d = dice();
  const float length = std::sqrt(a * a + b * b + c * c + d * d) + 1e-6f;
  const glm::fquat turn(a / length, b / length, c / length, d / length);
  const float now = glm::dot(corner[1] - corner[0], glm::cross(corner[2] - corner[0], corner[3] - corner[0])) / 6.0f;
  const float scale = std::cbrt(volume / std::abs(now));
  const glm::vec3 shown = color * (1.0f - 0.5f * (1.0f - kDarkest) * (1.0f + dice()));
  // Corners are shared: normals are means over a flake: the appearance of a grain.
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  for (const glm::vec3& one : corner) {
    out.vertices.push_back(centre + scale * (turn * one));
    out.colors.push_back({code(shown.x), code(shown.y), code(shown.z), kMoist});
  }
  for (const std::array<std::uint32_t, 3>& face : kFaces) out.triangles.push_back({first + face[0], first + face[1], first + face[2]});
}

}  // namespace

void append_debris(std::span<const ShownDebris> particles, const glm::vec3& down, AddedMesh& out) {
  if (particles.empty()) return;
  const std::size_t flakes = std::clamp<std::size_t>(kMostFlakes / particles.size(), 1, kMostFlakesOfOne);
  for (const ShownDebris& one : particles) {
    const std::size_t count = one.is_mist && !one.settled ? kMistFlakes : flakes;
    for (std::size_t n = 0; n < count; ++n) {
      Dice dice(one.number, n);
      const glm::vec3 place = dice.in_ball();
      if (one.settled) {
        append_flake(one.position + one.radius * (place - kResting * down), kFlakeVolume * one.volume / static_cast<float>(count),
                     kChipColor, dice, out);
      } else if (one.is_mist) {
        append_flake(one.position + kMistSpread * place, kMistVolume * one.volume / kMistFlakes, kMistColor, dice, out);
      } else {
        append_flake(one.position + kFlyingSpread * one.radius * place, kFlakeVolume * one.volume / static_cast<float>(count), kChipColor,
                     dice, out);
      }
    }
  }
}

bool DebrisPicture::copy_for_picture(bool) {
  next_.clear();
  for (const DebrisParticle& one : field_->particles())
    next_.push_back({glm::vec3(one.position), static_cast<float>(one.volume), static_cast<float>(field_->radius_of(one)), one.number,
                     one.settled, one.is_mist});
  down_ = glm::vec3(field_->site().down());
  const bool changed = !copied_ || next_ != shown_;
  copied_ = true;
  shown_.swap(next_);
  return changed;
}

void DebrisPicture::append_mesh(AddedMesh& out) const { append_debris(shown_, down_, out); }

}  // namespace burrhole
