// Tone curve that keeps shape and hue of bright bone: above 0.7 the brightest channel approaches 1 instead of being clipped.
vec3 rolled_off(vec3 color) {
  float bright = max(color.r, max(color.g, color.b));
  float over = max(bright - 0.7, 0.0);
  return color * (min(bright, 0.7) + 0.3 * over / (0.3 + over)) / max(bright, 1e-6);
}
