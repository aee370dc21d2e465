// Ambient occlusion: share of the sky visible from a surface point, from density samples in a cone around its normal. p: index, n: world
// unit normal. Samples lie on rings around the normal.
float sky_reach(int ring) { return 0.0011 * exp2(1.15 * float(ring)); }   // [m]
const float kSkySlope = 1.1;   // tangent of the angle from the normal
vec3 sky_lift(vec3 p, vec3 n) { return 1.2 * (edges.w * grain_at(p)) * n; }

// A block of side x side rays of one pixel shares the samples: each ray takes one of side x side. Where they hit one plane the mean of the
// results is that of all samples, and apart from the tone curve light is linear in it.
float open_sky(vec3 p, vec3 world, vec3 n) {
  const int kSpokes = 5, kSamples = 3 * kSpokes;
  vec3 a = normalize(abs(n.z) < 0.8 ? cross(n, vec3(0, 0, 1)) : cross(n, vec3(1, 0, 0)));
  vec3 b = cross(n, a);
  vec3 lift = sky_lift(p, n);
  int side = int(background_bottom.w);
  ivec2 place = ivec2(gl_FragCoord.xy) % side;
  float blocked = 0.0;
  for (int k = place.y * side + place.x; k < kSamples; k += side * side) {
    int ring = k / kSpokes;
    float angle = 1.2566371 * (float(k - kSpokes * ring) + 0.37 * float(ring));
    vec3 offset = sky_reach(ring) * normalize(n + kSkySlope * (cos(angle) * a + sin(angle) * b)) + lift;
    float weight = 1.0 - 0.2 * float(ring);
    blocked += weight * smoothstep(0.15, 0.85, drawn_density_at(p + index_from_displacement(offset), world + offset));
  }
  const float kWeights = float(kSpokes) * (1.0 + 0.8 + 0.6);
  return 1.0 - 0.85 * float(side * side) * blocked / kWeights;
}

// Whether the bounding box of a ring of samples, in index coordinates, meets the box of what changed.
bool occlusion_reads_changed(vec3 p, vec3 n) {
  const float across = 1.0 / sqrt(1.0 + kSkySlope * kSkySlope);   // cosine of the angle from the normal
  vec3 along = index_from_displacement(n);
  vec3 start = p + index_from_displacement(sky_lift(p, n));
  // A circle of radius 1 around n extends along index axis a by the part of its row that is perpendicular to n.
  vec3 rows = vec3(dot(index_rows[0].xyz, index_rows[0].xyz), dot(index_rows[1].xyz, index_rows[1].xyz), dot(index_rows[2].xyz, index_rows[2].xyz));
  vec3 extent = sqrt(max(rows - along * along, vec3(0.0)));
  bool meets = false;
  for (int ring = 0; ring < 3; ++ring) {
    float reach = across * sky_reach(ring);
    vec3 centre = start + reach * along;
    vec3 half_box = kSkySlope * reach * extent;
    meets = meets || (all(greaterThan(centre + half_box, changed_lo.xyz)) && all(lessThan(centre - half_box, changed_hi.xyz)));
  }
  return meets;
}
