// First hit of the 0.5 level of the volume along each pixel's ray. surface.frag then lights the hits.
// View depth t [m] is the ray parameter: p = eye + t * direction with direction . forward = 1.
#include "frame.glsl"
#include "background.glsl"
#include "volume.glsl"
#include "span.glsl"
layout(location = 0) out vec4 picture;
layout(location = 1) out float hit_depth;   // t; negative on a face of the box or the cut; 0 where nothing was hit; DETAIL: times kOfDetail
#ifdef PROBE
layout(location = 2) out vec4 probe;   // xyz: hit in index coordinates; w: samples taken, negative where nothing was hit
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
#ifdef HOLE
  vec2 hole = hole_samples(direction_index, span.enter, step_depth);
  bool in_hole = float(n) > hole.x && float(n) < hole.y;
  while (n <= last && (in_hole || density_at(p) < 0.5)) {
    n = in_hole ? int(ceil(hole.y)) : n + leap(p, reach);
    p = start + float(n) * stride;
    in_hole = float(n) > hole.x && float(n) < hole.y;
    ++samples;
  }
#else
  while (n <= last && density_at(p) < 0.5) {
    n += leap(p, reach);
    p = start + float(n) * stride;
    ++samples;
  }
#endif
  bool hit = n <= last;

  // The surface lies between sample n - 1, which is empty, and sample n; on a face of the box or the cut it is at the start of the ray.
  float outside = n == 0 ? 0.0 : float(n) - 1.0;
  float inside = float(n);
#ifdef HOLE
  if (inside >= hole.y) outside = max(outside, hole.y);   // in the hole the detail shows the surface
#endif
  for (int i = 0; i < int(light.w); ++i) {
    float middle = 0.5 * (outside + inside);
    bool solid = density_at(start + middle * stride) >= 0.5;
    inside = solid ? middle : inside;
    outside = solid ? outside : middle;
  }
  float t = span.enter + inside * step_depth;
  picture = vec4(background(gl_FragCoord.y / lens.w), 1.0);
#ifdef DETAIL
  hit_depth = kOfDetail * (hit ? (n == 0 && span.by_cut ? -t : t) : 0.0);
#else
  hit_depth = hit ? (n == 0 ? -t : t) : 0.0;
#endif
  gl_FragDepth = hit ? depth_from_view(t) : 1.0;
#ifdef PROBE
  probe = vec4(start + inside * stride, hit ? float(samples) : -float(samples));
#ifdef HOLE
  probe.xyz *= hole_hi.w;   // in voxels of the bone
#endif
#ifdef DETAIL
  probe.xyz += part.xyz;
#endif
#endif
}
