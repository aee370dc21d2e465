// Brushed steel: it mirrors a simple grey room (bright above, dark horizon), with the specular highlight of the light. A section of the bit
// (app/view/cut_mesh.h: normals of length 2 where it cuts, 3 elsewhere) is hatched, orange where it cuts and grey elsewhere.
#include "frame.glsl"
layout(location = 0) in vec3 world_normal;
layout(location = 1) in vec3 world_position;
layout(location = 0) out vec4 picture;
#ifdef LAYER
layout(binding = 4) uniform sampler2D hit_depth;   // of raycast.frag: the bone, which is drawn in a picture of its own
#endif
#ifdef FOG
#include "fog.glsl"
#endif
#ifdef PROBE
layout(location = 2) out vec4 probe;   // the tool is not a hit of the volume
#endif

vec3 room(vec3 d) {
  float up = dot(d, light.xyz);
  vec3 grey = mix(vec3(0.40, 0.42, 0.45), vec3(0.93, 0.95, 0.97), smoothstep(-0.6, 0.7, up));
  return grey - 0.22 * (1.0 - smoothstep(0.0, 0.22, abs(up + 0.12)));   // dark line between floor and wall
}

// Hatching at 45 degrees in the plane of the section, as in drawings; its mean where it is finer than the pixels.
vec3 section_color(float part, vec3 n) {
  const float kPitch = 0.8e-3, kWidth = 0.14;   // [m]; of a line, share of the pitch
  vec3 right = normalize(abs(n.z) < 0.9 ? cross(n, vec3(0.0, 0.0, 1.0)) : cross(n, vec3(1.0, 0.0, 0.0)));
  float along = dot(world_position, right + cross(right, n)) * 0.70711 / kPitch;
  float pixel = fwidth(along);
  float line = 1.0 - smoothstep(0.5 * kWidth, 0.5 * kWidth + pixel, abs(fract(along) - 0.5));
  line = mix(line, kWidth, smoothstep(0.3, 0.6, pixel));
  vec3 base = part < 2.5 ? vec3(0.87, 0.47, 0.19) : vec3(0.68, 0.71, 0.74);
  return base * (1.0 - 0.45 * line);
}

void main() {
#ifdef LAYER
  float bone = abs(texelFetch(hit_depth, ivec2(gl_FragCoord.xy), 0).r);
  bone = bone > 1e6 ? bone / kOfDetail : bone;
  if (bone > 0.0 && 1.0 / gl_FragCoord.w > bone) discard;   // w is the view depth
#endif
  vec3 to_eye = normalize(eye_world.xyz - world_position);
  vec3 n = normalize(world_normal);
  n = dot(n, to_eye) < 0.0 ? -n : n;
  vec3 mirrored = reflect(-to_eye, n);
  float direct = light_terms.y * max(dot(n, light.xyz), 0.0);
  float glint = light_terms.y * pow(max(dot(mirrored, light.xyz), 0.0), 32.0);
  float rim = pow(1.0 - max(dot(n, to_eye), 0.0), 4.0);
  vec3 steel = vec3(0.70, 0.72, 0.75);
  picture = vec4(steel * (0.35 * light_terms.x + 0.40 * direct + 0.65 * room(mirrored)) + 0.4 * glint + 0.12 * rim, 1.0);
  float part = length(world_normal);
  vec3 section = section_color(part, n);   // before the branch: it has derivatives
  if (part > 1.5) picture.rgb = section;
#ifdef FOG
  picture.rgb = fogged(picture.rgb, 1.0 / gl_FragCoord.w);
#endif
#ifdef PROBE
  probe = vec4(0.0);
#endif
}
