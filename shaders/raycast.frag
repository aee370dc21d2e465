// First hit of the 0.5 level of the volume along each pixel's ray, shaded once after the loop ([AcostaLiu07] section 4).
// View depth t [m] is the ray parameter: p = eye + t * direction with direction . forward = 1.
#include "frame.glsl"
#include "background.glsl"
#include "volume.glsl"
#include "shade.glsl"
#include "span.glsl"
layout(location = 0) out vec4 picture;
#ifdef PROBE
layout(location = 1) out vec4 probe;   // xyz: hit in index coordinates; w: samples taken, negative where nothing was hit
#endif

void main() {
  vec2 ndc = 2.0 * gl_FragCoord.xy / lens.zw - 1.0;
  vec3 direction_index = forward_index.xyz + ndc.x * right_index.xyz + ndc.y * up_index.xyz;
  vec3 direction_world = forward_world.xyz + ndc.x * right_world.xyz + ndc.y * up_world.xyz;
  Span span = visible_span(direction_index, direction_world);
  float step_depth = dims.w / length(direction_index);
  vec3 start = eye_index.xyz + span.enter * direction_index;
  vec3 stride = step_depth * direction_index;
  float reach = max(abs(stride.x), max(abs(stride.y), abs(stride.z)));
  int last = span.leave > span.enter ? int(floor((span.leave - span.enter) / step_depth)) : -1;

  int n = 0;
  int samples = last >= 0 ? 1 : 0;
  vec3 p = start;
  while (n <= last && density_at(p) < 0.5) {
    n += leap(p, reach);
    p = start + float(n) * stride;
    ++samples;
  }
  bool hit = n <= last;
  bool is_face = n == 0;

  // The surface lies between sample n - 1, which is empty, and sample n; on a cut face it is the start itself.
  float outside = is_face ? 0.0 : float(n) - 1.0;
  float inside = float(n);
  for (int i = 0; i < int(light.w); ++i) {
    float middle = 0.5 * (outside + inside);
    bool solid = density_at(start + middle * stride) >= 0.5;
    inside = solid ? middle : inside;
    outside = solid ? outside : middle;
  }
  p = start + inside * stride;
  float t = span.enter + inside * step_depth;

  vec3 color = background(gl_FragCoord.y / lens.w);
  float depth = 1.0;
  if (hit) {
    vec3 to_eye = -normalize(direction_world);
    vec3 normal = is_face ? span.normal : surface_normal(p, to_eye);
    color = shade(p, eye_world.xyz + t * direction_world, normal, to_eye, is_face);
    depth = lens.y / (lens.y - lens.x) * (1.0 - lens.x / t);
  }
  picture = vec4(color, 1.0);
  gl_FragDepth = depth;
#ifdef PROBE
  probe = vec4(p, hit ? float(samples) : -float(samples));
#endif
}
