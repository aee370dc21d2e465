// Share of the light that passes the tool. world: a point. The texture has depths of the tool seen from the light, 1 where there is none.
layout(binding = 8) uniform sampler2DShadow tool_from_light;
float light_past_tool(vec3 world) {
  vec3 at = 0.5 * (light_from_world * vec4(world, 1.0)).xyz + 0.5;
  return textureLod(tool_from_light, vec3(at.xy, min(at.z, 1.0)), 0.0);   // beyond all of the tool is still behind it
}
