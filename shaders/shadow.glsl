// Share of the light that reaches a surface point through the drawn volume. p: index, n: world unit normal.
// The spacing of samples is below a voxel near the point and increases; the last is 16 mm away for voxels of 0.25 mm.
float light_reaching(vec3 p, vec3 world, vec3 n) {
  float voxel = edges.w * grain_at(p);
  vec3 start = 1.5 * voxel * n;
  float way = 0.0;
  float blocked = 0.0;
  for (int i = 0; i < 28; ++i) {
    way += min(0.7 * voxel * pow(1.08, float(i)), 0.001);
    vec3 offset = start + way * light.xyz;
    blocked = max(blocked, smoothstep(0.3, 0.7, drawn_density_at(p + index_from_displacement(offset), world + offset)));
  }
  return 1.0 - blocked;
}
