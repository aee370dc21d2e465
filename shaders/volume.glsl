// The two textures of the paper (section 4), the density field for rays, and functions that read them. Index coordinates: voxel centres at
// integers.
layout(binding = 0) uniform sampler3D normal_opacity;   // RGB: normal, eq. 5; A: occupancy x remaining of bone
layout(binding = 1) uniform sampler3D color_soft;       // RGB: colour; A: occupancy of dura and brain
layout(binding = 6) uniform sampler3D seen_field;       // R: the larger of both, finer

vec3 texture_from_index(vec3 index) { return (index + 0.5) / dims.xyz; }

float bone_at(vec3 index) { return textureLod(normal_opacity, texture_from_index(index), 0.0).a; }
float soft_at(vec3 index) { return textureLod(color_soft, texture_from_index(index), 0.0).a; }

// The density whose 0.5 level is drawn.
float density_at(vec3 index) { return textureLod(seen_field, texture_from_index(index), 0.0).r; }

// Number of voxels over which the density near p is a mean: lengths in voxels are multiplied by it. 1 except near the faces of a detail.
#ifdef DETAIL
layout(binding = 7) uniform sampler3D whole_field;     // as seen_field, of the whole volume
float grain_at(vec3 p) {
  vec3 inside = min(p, dims.xyz - 1.0 - p);
  return mix(part.w, 1.0, smoothstep(blend.x, blend.x + blend.y, min(inside.x, min(inside.y, inside.z))));
}
#else
float grain_at(vec3 p) { return 1.0; }
#endif

// The drawn density: 0 outside the box of the cells and on the far side of the cut. p: index, world: the same point.
float drawn_density_at(vec3 p, vec3 world) {
#ifdef DETAIL
  vec3 q = (p + part.xyz) / part.w;
  bool inside = all(greaterThan(q, vec3(-0.5))) && all(lessThan(q, whole_dims.xyz - 0.5));
  bool near = all(greaterThanEqual(p, vec3(0.0))) && all(lessThanEqual(p, dims.xyz - 1.0));
#else
  bool inside = all(greaterThan(p, vec3(-0.5))) && all(lessThan(p, dims.xyz - 0.5));
#endif
#ifdef CUT
  inside = inside && dot(cut.xyz, world) <= cut.w;
#endif
#ifdef DETAIL
  return inside ? (near ? density_at(p) : textureLod(whole_field, (q + 0.5) / whole_dims.xyz, 0.0).r) : 0.0;
#else
  return inside ? density_at(p) : 0.0;
#endif
}

// Gradient in index coordinates to world direction (covariant, correct for sheared volumes); displacements use the transposed map.
vec3 world_from_gradient(vec3 g) { return g.x * index_rows[0].xyz + g.y * index_rows[1].xyz + g.z * index_rows[2].xyz; }
vec3 index_from_displacement(vec3 d) { return vec3(dot(index_rows[0].xyz, d), dot(index_rows[1].xyz, d), dot(index_rows[2].xyz, d)); }

// [AcostaLiu07] eq. 6, world directions; not renormalised: its length shows how much of a normal is stored.
vec3 stored_normal(vec3 p) {
  vec3 n = 2.0 * (textureLod(normal_opacity, texture_from_index(p), 0.0).rgb - 0.5);
  return world_from_bone[0].xyz * n.x + world_from_bone[1].xyz * n.y + world_from_bone[2].xyz * n.z;
}

#ifdef RECOMPUTED
// Gradient of the present density, by differences between the corners of the voxel around p: closer and smoother than differences along the
// axes.
vec3 surface_normal(vec3 p, vec3 fallback) {
  vec3 g = vec3(0.0);
  float grain = grain_at(p);
  for (int c = 0; c < 8; ++c) {
    vec3 corner = 2.0 * vec3(c & 1, (c >> 1) & 1, c >> 2) - 1.0;
    g -= 0.25 * corner * density_at(p + 0.5 * grain * corner);
  }
  vec3 n = world_from_gradient(g);
  float size = length(n);
  return size * edges.w > 0.01 ? n / size : fallback;
}
#else
// Normal of the filtered texels, renormalised; `fallback` where no normal is stored (0.5, 0.5, 0.5).
vec3 surface_normal(vec3 p, vec3 fallback) {
  vec3 n = stored_normal(p);
#ifdef FINISH
  // A wider mean removes the steps of a surface with an edge of one voxel.
  n *= 0.25;
  float grain = grain_at(p);
  for (int c = 0; c < 8; ++c) n += 0.09375 * stored_normal(p + 1.25 * grain * (vec3(c & 1, (c >> 1) & 1, c >> 2) - 0.5) * 2.0);
#endif
  float size = length(n);
  return size > 0.15 ? n / size : fallback;
}
#endif
