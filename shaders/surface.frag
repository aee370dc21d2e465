// The light on what the rays hit, at the depth that raycast.frag found; the depth test leaves out all other pixels.
#include "frame.glsl"
#include "volume.glsl"
#include "shade.glsl"
#include "span.glsl"
layout(binding = 4) uniform sampler2D hit_depth;   // depth buffer of the hits
layout(location = 0) out vec4 picture;

void main() {
  vec2 ndc = 2.0 * gl_FragCoord.xy / lens.zw - 1.0;
  vec3 direction_index = forward_index.xyz + ndc.x * right_index.xyz + ndc.y * up_index.xyz;
  vec3 direction_world = forward_world.xyz + ndc.x * right_world.xyz + ndc.y * up_world.xyz;
  Span span = visible_span(direction_index, direction_world);
  float t = view_from_depth(texelFetch(hit_depth, ivec2(gl_FragCoord.xy), 0).r);
  // A depth of 32 bits keeps t to 1e-7; a ray that starts inside shows the face that it enters by.
  bool is_face = t <= span.enter * (1.0 + 1e-6);
  vec3 p = eye_index.xyz + t * direction_index;
  vec3 to_eye = -normalize(direction_world);
  vec3 normal = is_face ? span.normal : surface_normal(p, to_eye);
  picture = vec4(shade(p, eye_world.xyz + t * direction_world, normal, to_eye, is_face), 1.0);
}
