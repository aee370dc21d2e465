// Presentation only, compiled out unless FINISH is set: ambient occlusion from the volume itself, a fine grain and soft highlights.
// Share of the sky that a surface point sees, from density samples in a cone round its normal. p: index, n: world unit normal.
float open_sky(vec3 p, vec3 world, vec3 n) {
  vec3 a = normalize(abs(n.z) < 0.8 ? cross(n, vec3(0, 0, 1)) : cross(n, vec3(1, 0, 0)));
  vec3 b = cross(n, a);
  float blocked = 0.0;
  float weight_sum = 0.0;
  for (int ring = 0; ring < 3; ++ring) {
    float reach = 0.0011 * exp2(1.15 * float(ring));
    for (int spoke = 0; spoke < 5; ++spoke) {
      float angle = 1.2566371 * (float(spoke) + 0.37 * float(ring));
      vec3 offset = reach * normalize(n + 1.1 * (cos(angle) * a + sin(angle) * b)) + 1.2 * edges.w * n;
      vec3 q = p + index_from_displacement(offset);
      bool inside = all(greaterThan(q, vec3(-0.5))) && all(lessThan(q, dims.xyz - 0.5));
#ifdef CUT
      inside = inside && dot(cut.xyz, world + offset) <= cut.w;
#endif
      float weight = 1.0 - 0.2 * float(ring);
      blocked += inside ? weight * smoothstep(0.15, 0.85, density_at(q)) : 0.0;
      weight_sum += weight;
    }
  }
  return 1.0 - 0.85 * blocked / weight_sum;
}

// Bright bone keeps its shape and hue: above 0.7 the brightest channel approaches 1 instead of being cut off there.
vec3 rolled_off(vec3 color) {
  float bright = max(color.r, max(color.g, color.b));
  float over = max(bright - 0.7, 0.0);
  return color * (min(bright, 0.7) + 0.3 * over / (0.3 + over)) / max(bright, 1e-6);
}

uint mixed(uvec3 v) {
  uint h = v.x * 0x9E3779B1u ^ v.y * 0x85EBCA77u ^ v.z * 0xC2B2AE3Du;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  return h ^ (h >> 13);
}

// Value noise in 0..1 on a unit lattice.
float noise(vec3 x) {
  ivec3 cell = ivec3(floor(x));
  vec3 f = smoothstep(0.0, 1.0, x - vec3(cell));
  float sum = 0.0;
  for (int c = 0; c < 8; ++c) {
    ivec3 corner = ivec3(c & 1, (c >> 1) & 1, c >> 2);
    vec3 w = mix(1.0 - f, f, vec3(corner));
    sum += w.x * w.y * w.z * float(mixed(uvec3(cell + corner)) >> 8) / 16777216.0;
  }
  return sum;
}

// Factor round 1 on a colour; fixed to the bone, since it is a function of index position in metres.
float grain(vec3 p) {
  vec3 metres = p * edges.xyz;
  return 0.95 + 0.06 * noise(metres / 0.0016) + 0.04 * noise(metres / 0.0004);
}
