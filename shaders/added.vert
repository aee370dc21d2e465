#include "frame.glsl"
layout(location = 0) in vec3 position;   // bone frame [m]
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 own_color;  // a: shine
layout(location = 3) in float own_unlit;
layout(location = 0) out vec3 world_normal;
layout(location = 1) out vec3 world_position;
layout(location = 2) out vec4 color;
layout(location = 3) out float unlit;
void main() {
  world_normal = mat3(world_from_bone_at) * normal;
  world_position = (world_from_bone_at * vec4(position, 1.0)).xyz;
  color = own_color;
  unlit = own_unlit;
  gl_Position = clip_from_bone * vec4(position, 1.0);
}
