// One slice: opacity is the density ([AcostaLiu07] section 4), light as for rays; blending composites back to front.
#include "frame.glsl"
#include "volume.glsl"
#include "shade.glsl"
#ifdef FOG
#include "fog.glsl"
#endif
layout(location = 0) in vec3 index;
layout(location = 0) out vec4 picture;

void main() {
  vec3 world = (world_from_index * vec4(index, 1.0)).xyz;
  vec3 direction = world - eye_world.xyz;
  vec3 to_eye = -normalize(direction);
  float opacity = density_at(index);
  bool is_face = false;
  // Length of this pixel's ray from one slice to the next.
  int axis = int(slices.x);
  float spacing = length(direction) * dims[axis] / (slices.y * max(abs(index[axis] - eye_index[axis]), 1e-6));
#ifdef CUT
  float depth = cut.w - dot(cut.xyz, world);
  if (depth < 0.0) discard;
  is_face = depth < spacing * max(dot(cut.xyz, to_eye), 0.0);   // the first slice behind the cut
#endif
  if (opacity <= 0.0) discard;
#ifdef CORRECT
  opacity = 1.0 - pow(1.0 - opacity, spacing / slices.w);
#endif
#ifdef CUT
  vec3 face = cut.xyz;
#else
  vec3 face = to_eye;
#endif
  // Where bone goes on to the end of the volume, the first slice of a ray shows a face too: density has no gradient across it.
  vec3 way = (index - eye_index.xyz) / max(abs(index[axis] - eye_index[axis]), 1e-6) * dims[axis] / slices.y;
  vec3 outside = max(-0.5 - (index - way), index - way - (dims.xyz - 0.5)) / max(abs(way), vec3(1e-6));
  int by = outside.x >= outside.y && outside.x >= outside.z ? 0 : (outside.y >= outside.z ? 1 : 2);
  if (!is_face && outside[by] > 0.0) {
    is_face = true;
    face = -sign(way[by]) * normalize(index_rows[by].xyz);
  }
  vec3 normal = is_face ? face : surface_normal(index, to_eye);
  picture = vec4(shade(index, world, normal, to_eye, is_face), opacity);
#ifdef FOG
  picture.rgb = fogged(picture.rgb, 1.0 / gl_FragCoord.w);
#endif
}
