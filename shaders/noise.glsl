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

// Distance to the nearest of random points, one per unit cell in its middle half, so that the eight nearest cells contain the nearest
// point.
float nearest_seed(vec3 x) {
  ivec3 base = ivec3(floor(x - 0.5));
  float least = 4.0;
  for (int c = 0; c < 8; ++c) {
    ivec3 cell = base + ivec3(c & 1, (c >> 1) & 1, c >> 2);
    uint h = mixed(uvec3(cell));
    vec3 seed = vec3(cell) + 0.25 + 0.5 * vec3(h & 1023u, (h >> 10) & 1023u, (h >> 20) & 1023u) / 1023.0;
    vec3 d = seed - x;
    least = min(least, dot(d, d));
  }
  return sqrt(least);
}
