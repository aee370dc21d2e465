// Slices of the volume across one of its axes, one instance per slice, the farthest from the eye first ([AcostaLiu07] section 5, after its
// reference 3). On each side of the eye the order is from far to near, so it is correct for every ray and position of the eye.
#include "frame.glsl"
layout(location = 0) out vec3 index;
void main() {
  int axis = int(slices.x);
  int count = int(slices.y);
  int beyond = int(slices.z);
  int n = gl_InstanceID < beyond ? count - 1 - gl_InstanceID : gl_InstanceID - beyond;
  vec3 share;
  share[axis] = (float(n) + 0.5) / slices.y;
  share[(axis + 1) % 3] = float(gl_VertexID & 1);
  share[(axis + 2) % 3] = float(gl_VertexID >> 1);
  index = share * dims.xyz - 0.5;
  gl_Position = clip_from_index * vec4(index, 1.0);
}
