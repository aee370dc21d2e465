// The tool seen from the light.
#include "frame.glsl"
layout(location = 0) in vec3 position;   // tool frame [m]
void main() { gl_Position = light_from_world * (world_from_tool * vec4(position, 1.0)); }
