// The interval of a ray inside the volume, and the number of empty samples that it may skip.
#ifdef SKIP
layout(binding = 2) uniform sampler3D skip_distance;   // Chebyshev distance [voxels / 255] to the nearest voxel that may be solid
#endif
struct Span {
  float enter, leave;   // view depth [m]
  vec3 normal;          // world normal of the face that the ray enters by
#ifdef DETAIL
  bool by_cut;          // it enters by the cut or near plane; the faces of a detail are no faces of bone
#endif
};

// The part of the ray inside the box of all voxel cells, in front of the near plane and on the kept side of the cut.
Span visible_span(vec3 direction_index, vec3 direction_world) {
  vec3 d = mix(direction_index, vec3(1e-9), lessThan(abs(direction_index), vec3(1e-9)));
  vec3 a = (vec3(-0.5) - eye_index.xyz) / d;
  vec3 b = (dims.xyz - 0.5 - eye_index.xyz) / d;
  vec3 first = min(a, b);
  vec3 last = max(a, b);
  float enter = max(first.x, max(first.y, first.z));
  float leave = min(last.x, min(last.y, last.z));
#ifdef DETAIL
  Span span = Span(enter, leave, vec3(0.0), false);
#else
  Span span = Span(enter, leave, vec3(0.0));
#endif
  int axis = first.x >= first.y && first.x >= first.z ? 0 : (first.y >= first.z ? 1 : 2);
  span.normal = -sign(d[axis]) * normalize(index_rows[axis].xyz);
  if (span.enter < lens.x) {
    span.enter = lens.x;
    span.normal = -normalize(direction_world);
#ifdef DETAIL
    span.by_cut = true;
#endif
  }
#ifdef CUT
  float height = dot(cut.xyz, eye_world.xyz) - cut.w;   // > 0: cut away
  float slope = dot(cut.xyz, direction_world);
  float crossing = -height / (abs(slope) < 1e-12 ? 1e-12 : slope);
  if (slope < 0.0 && crossing > span.enter) {
    span.enter = crossing;
    span.normal = cut.xyz;
#ifdef DETAIL
    span.by_cut = true;
#endif
  }
  if (slope >= 0.0) span.leave = min(span.leave, height > 0.0 ? -1.0 : crossing);
#endif
  return span;
}

#ifdef HOLE
// The samples x < n < y of a ray that lie in the part drawn as a detail. n counts steps of step_depth from view depth `enter`.
vec2 hole_samples(vec3 direction_index, float enter, float step_depth) {
  vec3 d = mix(direction_index, vec3(1e-9), lessThan(abs(direction_index), vec3(1e-9)));
  vec3 a = (hole_lo.xyz - eye_index.xyz) / d;
  vec3 b = (hole_hi.xyz - eye_index.xyz) / d;
  vec3 first = min(a, b);
  vec3 last = max(a, b);
  vec2 depths = vec2(max(first.x, max(first.y, first.z)), min(last.x, min(last.y, last.z)));
  return depths.x < depths.y ? (depths - enter) / step_depth : vec2(-1.0);
}
#endif

// Number of samples ahead that are certainly empty, at least 1. A voxel q at Chebyshev distance D from the nearest voxel of p contributes
// only if |q - p'| < 1, and |q - p'| >= D - 0.5 - |p' - p|; 1.6 instead of 1.5 is a reserve for rounding.
int leap(vec3 p, float reach) {
#ifdef SKIP
  return max(1, int(floor((255.0 * textureLod(skip_distance, texture_from_index(p), 0.0).r - 1.6) / reach)));
#else
  return 1;
#endif
}
