// Translucent bone: absorption and emission along each pixel's ray, front to back, after Beer and Lambert: over a length d with extinction
// s [1/m] a share exp(-s d) of the light passes. The picture depends on the step only by its discretisation error.
#include "frame.glsl"
#include "volume.glsl"
#include "shade.glsl"
#include "span.glsl"
#ifdef FOG
#include "fog.glsl"
#endif
layout(binding = 3) uniform sampler1D transfer;    // by density, 256 values: extinction [1/m] in R; with TINT in A, and in RGB the tint
layout(binding = 4) uniform sampler2D tool_depth;  // depth buffer of opaque surfaces
layout(location = 0) out vec4 picture;             // premultiplied by opacity
#ifdef PROBE
layout(location = 2) out vec4 probe;   // samples taken, negative: nothing is hit
#endif

const float kSpent = 1.0 / 1024.0;   // remaining light below which a ray ends: a quarter of an 8-bit level

// As stored, oriented towards the eye: a body is lit from both sides, and a surface hit from inside would be dark.
vec3 facing_normal(vec3 p, vec3 to_eye) {
  vec3 stored = stored_normal(p);
  float size = length(stored);
  return size > 0.15 ? stored * (dot(stored, to_eye) < 0.0 ? -1.0 : 1.0) / size : to_eye;
}

// RGB: tint of the tissue's colour, A: extinction.
vec4 transfer_at(float density) {
  vec4 stored = textureLod(transfer, (255.0 * density + 0.5) / 256.0, 0.0);
#ifdef TINT
  return stored;
#else
  return vec4(1.0, 1.0, 1.0, stored.r);
#endif
}

void main() {
  vec2 ndc = 2.0 * gl_FragCoord.xy / lens.zw - 1.0;
  vec3 direction_index = forward_index.xyz + ndc.x * right_index.xyz + ndc.y * up_index.xyz;
  vec3 direction_world = forward_world.xyz + ndc.x * right_world.xyz + ndc.y * up_world.xyz;
  Span span = visible_span(direction_index, direction_world);
  span.leave = min(span.leave, view_from_depth(texelFetch(tool_depth, ivec2(gl_FragCoord.xy), 0).r));
  float step_depth = dims.w / length(direction_index);
  float metres = length(direction_world);   // of a unit of view depth
  vec3 stride = step_depth * direction_index;
  float reach = max(abs(stride.x), max(abs(stride.y), abs(stride.z)));
  int count = span.leave > span.enter ? int(ceil((span.leave - span.enter) / step_depth)) : 0;
  vec3 to_eye = -normalize(direction_world);

  vec3 sum = vec3(0.0);
  float left = 1.0;
  int n = 0;
  int samples = 0;
  // Skips empty samples first, without the body of the following loop.
  vec3 start = eye_index.xyz + span.enter * direction_index;
  vec3 middle = start + 0.5 * stride;
  for (int ahead = leap(middle, reach); ahead > 1 && n < count; ahead = leap(middle + float(n) * stride, reach)) n += ahead;
  float t = span.enter;
  float soft = 0.0;
  while (n < count && left > kSpent && soft < 0.5) {
    // The middle of the step; the last step ends where the ray ends.
    float from = span.enter + float(n) * step_depth;
    float width = min(step_depth, span.leave - from);
    t = from + 0.5 * width;
    vec3 p = eye_index.xyz + t * direction_index;
    vec4 tissue = transfer_at(bone_at(p));
    float passes = exp(-tissue.a * width * metres);
#ifdef FOG
    sum += left * (1.0 - passes) * fogged(tissue.rgb * shade(p, eye_world.xyz + t * direction_world, facing_normal(p, to_eye), to_eye, true), t);
#else
    sum += left * (1.0 - passes) * tissue.rgb * shade(p, eye_world.xyz + t * direction_world, facing_normal(p, to_eye), to_eye, true);
#endif
    left *= passes;
#ifdef SOFT
    soft = soft_at(p);
#endif
    n += leap(p, reach);
    ++samples;
  }
#ifdef SOFT
  if (soft >= 0.5) {   // dura and brain are not part of the transfer function: they are opaque behind the bone
    // Their 0.5 level lies within the last step, over which occupancy is nearly linear.
    float outside = max(span.enter, t - step_depth);
    float low = soft_at(eye_index.xyz + outside * direction_index);
    t = low < 0.5 ? mix(outside, t, (0.5 - low) / (soft - low)) : outside;
    vec3 p = eye_index.xyz + t * direction_index;
#ifdef FOG
    sum += left * fogged(shade(p, eye_world.xyz + t * direction_world, facing_normal(p, to_eye), to_eye, false), t);
#else
    sum += left * shade(p, eye_world.xyz + t * direction_world, facing_normal(p, to_eye), to_eye, false);
#endif
    left = 0.0;
  }
#endif
  picture = vec4(sum, 1.0 - left);
#ifdef PROBE
  probe = vec4(0.0, 0.0, 0.0, -float(samples));
#endif
}
