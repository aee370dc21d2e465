/// volumes/phantom/head_sites.h: landmarks of a head phantom and sites of burrholes, found on its outer surface by the rules of surgeons.
///   Frame   bone frame of the head (head_shape.h).   Units  SI.   Errors  none.   Thread  any.
///   Source  each site names its rule in head_sites.cpp; lengths are along the skull's surface. "assumed": no rule gives the number.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "volumes/phantom/head_shape.h"

namespace burrhole {

struct HeadSite {
  std::string name;
  Vec3 point{0.0};             ///< [m] on the outer surface
  Vec3 normal{0.0, 0.0, 1.0};  ///< [-] outward, length 1, of the vault without sutures
};

/// @returns nasion, inion, vertex, bregma, lambda, ear_left and ear_right.
[[nodiscard]] std::vector<HeadSite> head_landmarks();
/// @returns the sites of burrholes, in the order of head_site_names().
[[nodiscard]] std::vector<HeadSite> head_sites();
[[nodiscard]] std::vector<std::string> head_site_names();
/// @returns a site by its name.
[[nodiscard]] std::optional<HeadSite> find_head_site(std::string_view name);

/// @returns the point reached from `from` after `length` [m] along the vault, in the plane through `from` that is spanned by the normal there
/// and `way`, first towards `way`. @pre `way` is not along the normal.
[[nodiscard]] Vec3 walk_on_vault(const Vec3& from, const Vec3& way, double length);

}  // namespace burrhole
