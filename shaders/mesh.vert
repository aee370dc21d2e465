#include "frame.glsl"
layout(location = 0) in vec3 position;   // bone frame [m]
layout(location = 1) in vec4 normal;     // w: 1 bone, 0 soft tissue
layout(location = 2) in vec4 own_color;  // a: share of the cut, 0 on the surface as loaded
layout(location = 0) out vec3 world_normal;
layout(location = 1) out vec3 world_position;
layout(location = 2) out vec3 color;
#ifdef TEXTURED
layout(location = 3) out vec3 bone_position;
layout(location = 4) out vec3 bone_normal;
layout(location = 5) out vec2 shares;   // of the cut, and of the textures
#endif
void main() {
  world_normal = mat3(world_from_bone_at) * normal.xyz;
  world_position = (world_from_bone_at * vec4(position, 1.0)).xyz;
  color = own_color.rgb;
#ifdef TEXTURED
  bone_position = position;
  bone_normal = normal.xyz;
  shares = vec2(own_color.a, normal.w);
#endif
  gl_Position = clip_from_bone * vec4(position, 1.0);
}
