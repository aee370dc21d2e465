// Light on the surface that rays hit, found by raycast.frag; the depth test excludes all other pixels.
#include "frame.glsl"
#include "volume.glsl"
#include "shade.glsl"
#include "span.glsl"
layout(binding = 4) uniform sampler2D hit_depth;   // of raycast.frag
layout(location = 0) out vec4 picture;

void main() {
  vec2 ndc = 2.0 * gl_FragCoord.xy / lens.zw - 1.0;
  vec3 direction_index = forward_index.xyz + ndc.x * right_index.xyz + ndc.y * up_index.xyz;
  vec3 direction_world = forward_world.xyz + ndc.x * right_world.xyz + ndc.y * up_world.xyz;
  float found = texelFetch(hit_depth, ivec2(gl_FragCoord.xy), 0).r;
#ifdef HOLE
  if (abs(found) > 1e6) discard;   // the detail is in front
#endif
#ifdef DETAIL
  if (abs(found) < 1e6) discard;   // the whole volume is in front
  found /= kOfDetail;
#endif
  bool is_face = found < 0.0;
  float t = abs(found);
  vec3 p = eye_index.xyz + t * direction_index;
  vec3 to_eye = -normalize(direction_world);
  vec3 normal = is_face ? visible_span(direction_index, direction_world).normal : surface_normal(p, to_eye);
  picture = vec4(shade(p, eye_world.xyz + t * direction_world, normal, to_eye, is_face), 1.0);
}
