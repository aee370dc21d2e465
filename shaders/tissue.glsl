// Procedural tissue, fixed to the bone. Original surface and cut bone differ ([TellesONeill10] section 3.3: one texture for the exterior,
// one for the interior), diploe has pores, dura has vessels. A voxel that was bone as loaded and is not bone now was cut, also after a
// checkpoint.
#include "noise.glsl"
layout(binding = 5) uniform sampler3D tissue;   // R: occupancy as loaded; G: sponginess of bone, share of dura in soft tissue

// 0 on the original surface .. 1 on a cut: share of bone removed three quarters of a voxel outside the surface. outward: index, one voxel
// long.
float cut_share(vec3 p, vec3 outward) {
  vec3 before = p + 0.75 * grain_at(p) * outward;
  return smoothstep(0.08, 0.3, textureLod(tissue, texture_from_index(before), 0.0).r - bone_at(before));
}

// Thin wavy lines at unit spacing across `way` (unit length), interrupted where a second noise is low. The noise is too weak to bend a line
// back on itself: vessels branch and end, but form no rings.
float vessel(vec3 x, vec3 way, float width) {
  float off = abs(fract(dot(x, way) + 0.5 * noise(x) + 0.12 * noise(2.3 * x)) - 0.5);
  return (1.0 - smoothstep(0.4 * width, width, off)) * smoothstep(0.35, 0.6, noise(0.43 * x + 17.0));
}

vec3 old_bone(vec3 color, vec3 metres) {
  float fibres = noise(metres / vec3(0.28e-3, 1.5e-3, 0.28e-3));
  float patches = noise(metres / 3.5e-3);
  float pits = 1.0 - smoothstep(0.05, 0.09, nearest_seed(metres / 2.6e-3));
  color *= vec3(0.90) + vec3(0.09, 0.10, 0.12) * fibres + 0.06 * patches;
  return mix(color, color * vec3(0.62, 0.50, 0.42), 0.6 * pits);
}

vec3 cut_bone(vec3 color, float spongy, vec3 metres) {
  // Dense bone is paler inside than at its surface, with the dots of its canals; the size of pores increases with the share of marrow.
  float canals = 1.0 - smoothstep(0.10, 0.22, nearest_seed(metres / 0.45e-3));
  vec3 dense = mix(color, vec3(0.97, 0.95, 0.90), 0.55) * (1.0 - 0.10 * canals);
  vec3 walls = mix(color, vec3(0.93, 0.82, 0.68), 0.65);
  float radius = 0.62 * smoothstep(0.15, 1.0, spongy);
  float pore = 1.0 - smoothstep(0.8 * radius, radius + 0.02, nearest_seed(metres / 0.85e-3) + 0.12 * (noise(metres / 0.3e-3) - 0.5));
  return mix(mix(dense, walls, smoothstep(0.1, 0.4, spongy)), vec3(0.40, 0.12, 0.09), 0.92 * pore * step(0.01, radius));
}

vec3 soft_tissue(vec3 color, float dura, vec3 metres, bool is_face) {
  float seen = is_face ? 0.0 : 1.0;   // vessels lie on the surface
  float trunk = seen * vessel(metres / 6.0e-3, vec3(0.8, 0.36, 0.48), 0.05);
  float branch = seen * vessel(metres / 2.8e-3 + 5.0, vec3(0.28, 0.96, 0.0), 0.06);
  vec3 sheet = color * (0.92 + 0.14 * noise(metres / vec3(0.5e-3, 2.2e-3, 0.5e-3)));   // the fibres of dura
  sheet = mix(sheet, vec3(0.60, 0.16, 0.15), max(0.85 * trunk, 0.6 * branch));
  vec3 folds = color * (0.88 + 0.18 * noise(metres / 2.5e-3));
  folds = mix(folds, vec3(0.45, 0.14, 0.22), 0.7 * max(trunk, 0.6 * branch));
  return mix(folds, sheet, smoothstep(0.3, 0.7, dura));
}

// 0 within a millimetre of the surface as loaded, where a scan's density decreases without marrow; 1 deeper.
float deep_share(vec3 p) {
  float least = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    vec3 offset = vec3(0.0);
    offset[axis] = 0.001 / edges[axis];
    least = min(least, min(textureLod(tissue, texture_from_index(p - offset), 0.0).r, textureLod(tissue, texture_from_index(p + offset), 0.0).r));
  }
  return smoothstep(0.4, 0.9, least);
}

// color: of the tissue at `inside` (index), the point of the volume that determines the colour of surface point p; pattern: the point of the
// patterns; is_face: p lies on a cut plane.
vec3 tissue_color(vec3 color, vec3 p, vec3 inside, vec3 pattern, vec3 outward, bool is_face) {
#ifdef DETAIL
  vec3 metres = (pattern + part.xyz) * edges.xyz;
#else
  vec3 metres = pattern * edges.xyz;
#endif
#ifdef DRAPE
  if (color.g > color.r) return color * (0.93 + 0.10 * noise(metres / 1.3e-3) + 0.06 * noise(metres / 9.0e-3));   // cloth; no tissue is green
#endif
  float kind = textureLod(tissue, texture_from_index(inside), 0.0).g;
#ifdef SOFT
  if (soft_at(inside) > bone_at(inside)) return soft_tissue(color, kind, metres, is_face);
#endif
  float cut_now = is_face ? 1.0 : cut_share(p, outward);
  return mix(old_bone(color, metres), cut_bone(color, kind * deep_share(inside), metres), cut_now);
}
