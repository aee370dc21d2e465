// Marks, by stencil, the hits of an earlier picture whose ambient occlusion may read a changed texel; draws nothing.
#include "frame.glsl"
#include "volume.glsl"
#include "occlusion.glsl"
#include "span.glsl"
#include "hit.glsl"

void main() {
  Hit hit = hit_here();
  if (!hit.is_drawn || !occlusion_reads_changed(hit.p, hit.normal)) discard;
}
