// The light that comes from a point of a surface. Include frame first. color: of the surface there; normal and to_eye: world, unit length;
// sky: share of the sky that is seen from there; reaching: share of the direct light that reaches it.
#ifdef FINISH
#include "finish.glsl"
#endif
vec3 lit(vec3 color, vec3 normal, vec3 to_eye, float sky, float reaching) {
  // [AcostaLiu07] section 4: C = Ia Cv + Id Cv max(N.L, 0); the headlight fill is our own, 0 disables it.
  float direct = light_terms.y * max(dot(normal, light.xyz), 0.0) * mix(0.45, 1.0, sky) * reaching;
  float fill = light_terms.z * max(dot(normal, to_eye), 0.0) * sky;
  color *= light_terms.x * sky + direct + fill;
#ifdef SPECULAR
  // Specular highlight of a wet surface [Blinn77]: a tenth of the light, within about 15 degrees of the mirror direction.
  color += 0.1 * light_terms.y * reaching * pow(max(dot(normal, normalize(light.xyz + to_eye)), 0.0), 40.0) * step(0.0, dot(normal, light.xyz));
#endif
#ifdef FINISH
  color = rolled_off(color);
#endif
  return color;
}
