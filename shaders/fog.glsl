// Fog by the distance from the plane of focus. t: view depth [m].
vec3 fogged(vec3 color, float t) {
  float d = (t - focus.x) * focus.y;
  return mix(fog.rgb, color, exp(-d * d));
}
