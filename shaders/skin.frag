// Skin as a thin translucent shell over the picture of bone and tool, and the opaque edge of its opening.
#include "frame.glsl"
#include "finish.glsl"
#ifdef FOG
#include "fog.glsl"
#endif
layout(location = 0) in vec3 world_normal;
layout(location = 1) in vec3 world_position;
layout(location = 2) in float share;
layout(location = 0) out vec4 picture;
layout(binding = 4) uniform sampler2D hit_depth;   // of raycast.frag: the bone, which is drawn in a picture of its own

void main() {
#ifndef RIM
  if (share < 0.0) discard;
#endif
#ifdef CUT
  if (dot(cut.xyz, world_position) > cut.w) discard;
#endif
  float bone = abs(texelFetch(hit_depth, ivec2(gl_FragCoord.xy), 0).r);
  bone = bone > 1e6 ? bone / kOfDetail : bone;
  float depth = 1.0 / gl_FragCoord.w;   // w is 1 / view depth
  if (bone > 0.0 && depth > bone) discard;
  vec3 to_eye = normalize(eye_world.xyz - world_position);
  vec3 n = normalize(world_normal);
  n = dot(n, to_eye) < 0.0 ? -n : n;   // lit from both sides
  float square_on = max(dot(n, to_eye), 0.05);
#ifdef RIM
  // Skin, then fat, then the red of muscle and galea.
  vec3 color = mix(skin.rgb, vec3(0.86, 0.72, 0.50), smoothstep(0.06, 0.14, share));
  color = mix(color, vec3(0.60, 0.22, 0.18), smoothstep(0.30, 0.42, share));
  float opacity = 1.0;
#else
  vec3 color = skin.rgb;
  float opacity = 1.0 - pow(1.0 - skin.w, 1.0 / square_on);   // the way through the shell grows with the angle
#endif
  color *= light_terms.x + light_terms.y * max(dot(n, light.xyz), 0.0) + light_terms.z * square_on;
  color += 0.05 * light_terms.y * pow(max(dot(n, normalize(light.xyz + to_eye)), 0.0), 24.0);   // a faint sheen
  color = rolled_off(color);
#ifdef FOG
  color = fogged(color, depth);
#endif
  picture = vec4(color, opacity);
}
