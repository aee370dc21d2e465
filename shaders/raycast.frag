// First hit of the 0.5 level of the volume along each pixel's ray, shaded once after the loop ([AcostaLiu07] section 4).
// View depth t [m] is the ray parameter: p = eye + t * direction with direction . forward = 1.
#include "frame.glsl"
#include "background.glsl"
#include "volume.glsl"
#include "shade.glsl"
#ifdef SKIP
layout(binding = 2) uniform sampler3D skip_distance;   // Chebyshev distance [voxels / 255] to the nearest voxel that may be solid
#endif
layout(location = 0) out vec4 picture;
#ifdef PROBE
layout(location = 1) out vec4 probe;   // xyz: hit in index coordinates; w: samples taken, negative where nothing was hit
#endif

struct Span {
  float enter, leave;   // view depth [m]
  vec3 normal;          // world normal of the face that the ray enters by
};

// The part of the ray inside the box of all voxel cells, in front of the near plane and on the kept side of the cut.
Span visible_span(vec3 direction_index, vec3 direction_world) {
  vec3 d = mix(direction_index, vec3(1e-9), lessThan(abs(direction_index), vec3(1e-9)));
  vec3 a = (vec3(-0.5) - eye_index.xyz) / d;
  vec3 b = (dims.xyz - 0.5 - eye_index.xyz) / d;
  vec3 first = min(a, b);
  vec3 last = max(a, b);
  Span span = Span(max(first.x, max(first.y, first.z)), min(last.x, min(last.y, last.z)), vec3(0.0));
  int axis = first.x >= first.y && first.x >= first.z ? 0 : (first.y >= first.z ? 1 : 2);
  span.normal = -sign(d[axis]) * normalize(index_rows[axis].xyz);
  if (span.enter < lens.x) {
    span.enter = lens.x;
    span.normal = -normalize(direction_world);
  }
#ifdef CUT
  float height = dot(cut.xyz, eye_world.xyz) - cut.w;   // above 0: cut away
  float slope = dot(cut.xyz, direction_world);
  float crossing = -height / (abs(slope) < 1e-12 ? 1e-12 : slope);
  if (slope < 0.0 && crossing > span.enter) {
    span.enter = crossing;
    span.normal = cut.xyz;
  }
  if (slope >= 0.0) span.leave = min(span.leave, height > 0.0 ? -1.0 : crossing);
#endif
  return span;
}

// How many samples ahead are surely empty, at least 1. A voxel q at Chebyshev distance D from the nearest voxel of p counts only where
// |q - p'| < 1, and |q - p'| >= D - 0.5 - |p' - p|; 1.6 instead of 1.5 leaves room for rounding.
int leap(vec3 p, float reach) {
#ifdef SKIP
  return max(1, int(floor((255.0 * textureLod(skip_distance, texture_from_index(p), 0.0).r - 1.6) / reach)));
#else
  return 1;
#endif
}

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
