// A pixel of the picture: the mean of its side x side rays.
layout(binding = 9) uniform sampler2D rays;
layout(location = 0) uniform int side;
layout(location = 0) out vec4 picture;

void main() {
  ivec2 first = side * ivec2(gl_FragCoord.xy);
  vec4 sum = vec4(0.0);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) sum += texelFetch(rays, first + ivec2(x, y), 0);
  picture = sum / float(side * side) + 1e-4;   // halves of a level are rounded up, as by shrink() in app/render/enlarge.cpp
}
