// Light on the surface that rays hit, found by raycast.frag; the depth test excludes all other pixels.
#include "frame.glsl"
#include "volume.glsl"
#include "shade.glsl"
#include "span.glsl"
#include "hit.glsl"
#ifdef FOG
#include "fog.glsl"
#endif
layout(location = 0) out vec4 picture;

void main() {
  Hit hit = hit_here();
  vec3 color = shade(hit.p, hit.world, hit.normal, hit.to_eye, hit.is_face);
#ifdef FOG
  color = fogged(color, hit.depth);
#endif
  if (!hit.is_drawn) discard;
  picture = vec4(color, 1.0);
}
