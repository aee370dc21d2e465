// Ambient occlusion: share of the sky visible from a surface point, from density samples in a cone around its normal. p: index, n: world
// unit normal.
float open_sky(vec3 p, vec3 world, vec3 n) {
  vec3 a = normalize(abs(n.z) < 0.8 ? cross(n, vec3(0, 0, 1)) : cross(n, vec3(1, 0, 0)));
  vec3 b = cross(n, a);
  float blocked = 0.0;
  float voxel = edges.w * grain_at(p);
  float weight_sum = 0.0;
  for (int ring = 0; ring < 3; ++ring) {
    float reach = 0.0011 * exp2(1.15 * float(ring));
    for (int spoke = 0; spoke < 5; ++spoke) {
      float angle = 1.2566371 * (float(spoke) + 0.37 * float(ring));
      vec3 offset = reach * normalize(n + 1.1 * (cos(angle) * a + sin(angle) * b)) + 1.2 * voxel * n;
      float weight = 1.0 - 0.2 * float(ring);
      blocked += weight * smoothstep(0.15, 0.85, drawn_density_at(p + index_from_displacement(offset), world + offset));
      weight_sum += weight;
    }
  }
  return 1.0 - 0.85 * blocked / weight_sum;
}
