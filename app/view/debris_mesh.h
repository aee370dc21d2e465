/// app/view/debris_mesh.h: chips and mist in pictures: each particle as some irregular flakes, tetrahedra, with a stated part of the volume of its bone.
///   A settled particle has its flakes in the ball that its loose chips fill; a flying one in a ball kFlyingSpread times as wide;
///   mist is fine specks with a small part of its volume, as opaque triangles cannot show a veil.
///   Frame  bone frame.   Units  m.   Errors  none.   Thread  any.   Random  from the number of a particle: a chip has the same flakes in all pictures.
#pragma once

#include <span>
#include <vector>

#include "app/view/added_mesh.h"
#include "core/debris/debris_field.h"

namespace burrhole {

/// What a picture shows of a particle.
struct ShownDebris {
  glm::vec3 position{0.0f};            ///< [m]
  float volume = 0.0f, radius = 0.0f;  ///< [m^3] of bone; [m] of the ball of its loose chips
  std::uint32_t number = 0;
  bool settled = false, is_mist = false;
  friend bool operator==(const ShownDebris&, const ShownDebris&) = default;
};

/// What the pictures of a field show. Particles that the bit holds are inside it, and not drawn.
class DebrisPicture final : public PictureSource {
 public:
  explicit DebrisPicture(const DebrisField& field) : field_(&field) {}
  [[nodiscard]] bool copy_for_picture(bool exactly) override;
  void append_mesh(AddedMesh& out) const override;

 private:
  const DebrisField* field_;
  std::vector<ShownDebris> shown_, next_;
  glm::vec3 down_{0.0f};
  bool copied_ = false;
};

inline constexpr std::size_t kMostFlakes = 150'000;  ///< of a picture, where there are fewer particles
inline constexpr std::size_t kMostFlakesOfOne = 16;
inline constexpr float kFlakeVolume =
    0.15f;  ///< [-] of the volume of the bone: with all of it the flakes, of which there are too few, would be 1 mm wide
inline constexpr float kFlyingSpread = 3.0f;

/// Appends the flakes of particles. @param down unit, bone frame.
void append_debris(std::span<const ShownDebris> particles, const glm::vec3& down, AddedMesh& out);

}  // namespace burrhole
