// The triangle that covers the screen, or rectangles of it, at the far plane; the fragment shader computes its ray from gl_FragCoord.
layout(location = 0) in vec2 corner;   // clip coordinates
void main() { gl_Position = vec4(corner, 1.0, 1.0); }
