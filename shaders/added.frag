// What effects add to the picture: triangles lit from both sides, with the light of bone, and wet where they shine. A share of a colour may be
// shown as it is, so that it can be read on a scale.
#include "frame.glsl"
#include "finish.glsl"
#ifdef FOG
#include "fog.glsl"
#endif
layout(location = 0) in vec3 world_normal;
layout(location = 1) in vec3 world_position;
layout(location = 2) in vec4 color;   // a: shine
layout(location = 3) in float unlit;   // share of the colour that light does not change
layout(location = 0) out vec4 picture;
#ifdef WET
#include "room.glsl"
#endif
#ifdef LAYER
layout(binding = 4) uniform sampler2D hit_depth;   // of raycast.frag: the bone, which is drawn in a picture of its own
#endif
#ifdef PROBE
layout(location = 2) out vec4 probe;   // no hit of the volume
#endif

void main() {
#ifdef CUT
  if (dot(cut.xyz, world_position) > cut.w) discard;
#endif
#ifdef LAYER
  float bone = abs(texelFetch(hit_depth, ivec2(gl_FragCoord.xy), 0).r);
  bone = bone > 1e6 ? bone / kOfDetail : bone;
  if (bone > 0.0 && 1.0 / gl_FragCoord.w > bone) discard;   // w is the view depth
#endif
  vec3 to_eye = normalize(eye_world.xyz - world_position);
  vec3 n = normalize(world_normal);
  n = dot(n, to_eye) < 0.0 ? -n : n;
#ifdef CUT
  // Of a closed body the inner side is seen through the cut alone, so it shows the section, which is dull.
  if (!gl_FrontFacing) n = cut.xyz;
  float shine = gl_FrontFacing ? color.a : 0.0;
#else
  float shine = color.a;
#endif
  vec3 shown = color.rgb * (light_terms.x + light_terms.y * max(dot(n, light.xyz), 0.0) + light_terms.z * max(dot(n, to_eye), 0.0));
  // A tight highlight of the film of fluid over a broad one of the uneven tissue below it.
  float towards = max(dot(n, normalize(light.xyz + to_eye)), 0.0) * step(0.0, dot(n, light.xyz));
  shown += shine * light_terms.y * (0.45 * pow(towards, 90.0) + 0.22 * pow(towards, 14.0));
  float moist = 0.18 * light_terms.x * pow(1.0 - max(dot(n, to_eye), 0.0), 3.0);   // at grazing angles
#ifdef WET
  shown += shine * (shine >= 0.5 ? room_mirrored(n, to_eye) : moist);   // a mesh may have dull and moist parts beside wet ones
#else
  shown += shine * moist;
#endif
  shown = mix(rolled_off(shown), color.rgb, unlit);
#ifdef FOG
  shown = fogged(shown, 1.0 / gl_FragCoord.w);
#endif
  picture = vec4(shown, 1.0);
#ifdef PROBE
  probe = vec4(0.0);
#endif
}
