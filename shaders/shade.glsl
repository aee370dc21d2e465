// The light on a point of the volume, for rays and slices alike. p: index, world: the same point, normal and to_eye: world, unit length;
// is_face: the point lies on a cut, where the colour is the one right there.
#ifdef FINISH
#include "finish.glsl"
#endif
vec3 shade(vec3 p, vec3 world, vec3 normal, vec3 to_eye, bool is_face) {
  // The colour of what lies under the surface: half of what a filtered look-up sees at the surface itself is outside the bone.
  vec3 inward = index_from_displacement(normal);
  vec3 inside = is_face ? p : p - 0.75 * inward / length(inward);
  vec3 color = textureLod(color_soft, texture_from_index(inside), 0.0).rgb;
  float sky = 1.0;
#ifdef FINISH
  sky = open_sky(p, world, normal);
  color *= grain(p);
#endif
  // [AcostaLiu07] section 4: C = Ia Cv + Id Cv max(N.L, 0); the headlight fill is ours and 0 switches it off.
  float direct = light_terms.y * max(dot(normal, light.xyz), 0.0) * mix(0.45, 1.0, sky);
  float fill = light_terms.z * max(dot(normal, to_eye), 0.0) * sky;
  color *= light_terms.x * sky + direct + fill;
#ifdef FINISH
  color = rolled_off(color);
#endif
  return color;
}
