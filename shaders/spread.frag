// The rays of a pixel that has only one: its colour, and hit depths that continue those of its neighbours, so that the edge of a tool that enters
// the bone there is as smooth as elsewhere.
layout(binding = 4) uniform sampler2D hit_depth;   // of one ray a pixel
layout(binding = 9) uniform sampler2D pixels;
layout(location = 0) uniform int side;
layout(location = 0) out vec4 picture;
layout(location = 1) out float hit;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 pixel = at / side;
  vec2 off = (vec2(at - side * pixel) + 0.5) / float(side) - 0.5;   // from the middle of the pixel
  ivec2 next = clamp(pixel + ivec2(sign(off)), ivec2(0), textureSize(hit_depth, 0) - 1);
  float here = texelFetch(hit_depth, pixel, 0).r;
  float beside = texelFetch(hit_depth, ivec2(next.x, pixel.y), 0).r;
  float above = texelFetch(hit_depth, ivec2(pixel.x, next.y), 0).r;
  // Neighbours without a hit, on a face, of the other level or of another surface differ by more.
  bool smooth_here = max(abs(beside - here), abs(above - here)) <= 0.01 * abs(here);
  picture = texelFetch(pixels, pixel, 0);
  hit = smooth_here ? here + abs(off.x) * (beside - here) + abs(off.y) * (above - here) : here;
}
