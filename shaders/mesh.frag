// The surface of bone as triangles, with the light of rays. The mesh is closed: where a cut leaves the inner side of a triangle as the nearest
// one, the ray of the pixel entered the bone through the plane of the cut, so the pixel shows the section there.
#include "frame.glsl"
#include "light.glsl"
#ifdef FOG
#include "fog.glsl"
#endif
#ifdef TEXTURED
#include "mesh_texture.glsl"
#endif
layout(location = 0) in vec3 world_normal;
layout(location = 1) in vec3 world_position;
layout(location = 2) in vec3 color;
#ifdef TEXTURED
layout(location = 3) in vec3 bone_position;
layout(location = 4) in vec3 bone_normal;
layout(location = 5) in vec2 shares;   // of the cut, and of the textures
#endif
layout(location = 0) out vec4 picture;
layout(location = 1) out float hit_depth;   // view depth [m], negative on a section, as of raycast.frag
#ifdef PROBE
layout(location = 2) out vec4 probe;   // xyz: index; w: 1
#endif
#ifdef CUT
layout(binding = 1) uniform sampler3D color_soft;   // a: soft tissue
#endif

void main() {
#ifdef CUT
  if (dot(cut.xyz, world_position) > cut.w) discard;
#endif
  float t = 1.0 / gl_FragCoord.w;   // w is the view depth
  vec2 ndc = 2.0 * gl_FragCoord.xy / lens.zw - 1.0;
  vec3 direction_world = forward_world.xyz + ndc.x * right_world.xyz + ndc.y * up_world.xyz;
  vec3 direction_index = forward_index.xyz + ndc.x * right_index.xyz + ndc.y * up_index.xyz;
  vec3 normal = normalize(world_normal);
  vec3 base = color;
#ifdef TEXTURED
  vec3 outside = color;
  vec3 inside = color;
#ifdef EXTERIOR
  outside = exterior_color(bone_position, bone_normal, t);
#endif
#ifdef INTERIOR
  inside = interior_color(bone_position, t);
#endif
  base = mix(color, mix(outside, inside, shares.x), shares.y);
#endif
  bool is_section = false;
#ifdef CUT
  float to_plane = (cut.w - dot(cut.xyz, eye_world.xyz)) / dot(cut.xyz, direction_world);
  is_section = !gl_FrontFacing && to_plane > 0.0;
  if (is_section) {
    t = to_plane;
    normal = cut.xyz;
    vec4 own = textureLod(color_soft, (eye_index.xyz + t * direction_index + 0.5) / dims.xyz, 0.0);
    base = own.rgb;
#ifdef INTERIOR
    vec3 world = eye_world.xyz + t * direction_world;
    vec3 at = transpose(mat3(world_from_bone_at)) * (world - world_from_bone_at[3].xyz);
    base = mix(interior_color(at, t), own.rgb, step(0.5, own.a));
#endif
  }
#endif
  vec3 shown = lit(base, normal, -normalize(direction_world), 1.0, 1.0);
#ifdef FOG
  shown = fogged(shown, t);
#endif
  picture = vec4(shown, 1.0);
  hit_depth = is_section ? -t : t;
#ifdef PROBE
  probe = vec4(eye_index.xyz + t * direction_index, 1.0);
#endif
}
