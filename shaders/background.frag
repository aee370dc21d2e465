#include "frame.glsl"
#include "background.glsl"
layout(location = 0) out vec4 picture;
void main() {
  picture = vec4(background(gl_FragCoord.y / lens.w), 1.0);
  gl_FragDepth = 1.0;
}
