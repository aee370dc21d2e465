// Marks, by stencil, the hits of rays in the shadow of the tool; draws nothing.
#include "frame.glsl"
#include "tool_shadow.glsl"
layout(binding = 4) uniform sampler2D hit_depth;   // of raycast.frag
void main() {
  vec2 ndc = 2.0 * gl_FragCoord.xy / lens.zw - 1.0;
  vec3 direction_world = forward_world.xyz + ndc.x * right_world.xyz + ndc.y * up_world.xyz;
  float t = abs(texelFetch(hit_depth, ivec2(gl_FragCoord.xy), 0).r);
  t = t > 1e6 ? t / kOfDetail : t;
  if (t == 0.0 || light_past_tool(eye_world.xyz + t * direction_world) == 1.0) discard;
}
