#include "frame.glsl"
layout(location = 0) in vec3 position;   // tool frame [m]
layout(location = 1) in vec3 normal;
layout(location = 0) out vec3 world_normal;
layout(location = 1) out vec3 world_position;
void main() {
  world_normal = mat3(world_from_tool) * normal;
  world_position = (world_from_tool * vec4(position, 1.0)).xyz;
  gl_Position = clip_from_tool * vec4(position, 1.0);
}
