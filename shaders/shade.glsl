// Light at a point of the volume, for rays and slices. p: index, world: the same point; normal and to_eye: world, unit length;
// is_face: the point lies on a cut, where the colour is sampled at the point itself.
#include "light.glsl"
#ifdef OCCLUSION
#include "occlusion.glsl"
#endif
#ifdef SHADOW
#include "shadow.glsl"
#endif
#ifdef TOOL_SHADOW
#include "tool_shadow.glsl"
#endif
#ifdef TISSUE
#include "tissue.glsl"
#endif
vec3 shade(vec3 p, vec3 world, vec3 normal, vec3 to_eye, bool is_face) {
  // Colour from below the surface: half of the texels filtered at the surface itself are outside the bone.
  vec3 outward = index_from_displacement(normal);
  outward /= length(outward);
  vec3 inside = is_face ? p : p - 0.75 * grain_at(p) * outward;
#ifdef LABELS
  vec3 color = textureLod(color_soft, texture_from_index(inside), 0.0).rgb;
#else
  vec3 color = vec3(0.93, 0.88, 0.76);   // ivory
#endif
#ifdef TISSUE
  // Patterns of tissue are those at the same depth in bone for voxels of any size.
  color = tissue_color(color, p, inside, is_face ? p : p - 0.75 * light_terms.w * outward, outward, is_face);
#endif
  float sky = 1.0;
#ifdef OCCLUSION
  sky = open_sky(p, world, normal);
#endif
  float reaching = 1.0;
#ifdef SHADOW
  reaching = light_reaching(p, world, normal);
#endif
#ifdef TOOL_SHADOW
  reaching *= light_past_tool(world);
#endif
  return lit(color, normal, to_eye, sky, reaching);
}
