// The operating room that a film of fluid mirrors. Include frame first. Own, chosen by eye: round the light, which is the operating lamp, smaller lamps
// under the ceiling on all sides, so that a level liquid mirrors one from most of them; pale walls, a dark floor.

// Radiance [-], of white paper in the lamp's light 1, from a direction: world, unit length.
float room_light(vec3 way) {
  float up = dot(way, light.xyz);
  vec3 across = normalize(cross(abs(light.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(0.0, 1.0, 0.0), light.xyz));
  float lamp = 16.0 * smoothstep(0.965, 0.99, up);
  // In a plane across the light.
  vec2 place = vec2(dot(way, across), dot(way, cross(light.xyz, across))) / max(up, 0.12);
  float far = length(fract(place / 1.1) - 0.5);
  float lamps = (14.0 * (1.0 - smoothstep(0.16, 0.26, far)) + 0.8 * (1.0 - smoothstep(0.2, 0.5, far))) * smoothstep(0.12, 0.4, up);
  float walls = mix(0.15, 1.0, smoothstep(-0.3, 0.5, up));
  return walls + lamps + lamp;
}

// What a film of water or serum (n = 1.35) sends to the eye of that room. Fresnel by [Schlick94]. normal, to_eye: world, unit length.
float room_mirrored(vec3 normal, vec3 to_eye) {
  float face = clamp(dot(normal, to_eye), 0.0, 1.0);
  float share = 0.022 + 0.978 * pow(1.0 - face, 5.0);
  return light_terms.y * share * room_light(reflect(-to_eye, normal));
}
