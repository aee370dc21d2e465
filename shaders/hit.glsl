// The hit that raycast.frag found at this pixel. Include frame, volume and span first. A pixel of the other level must be discarded at the
// end: Mesa's compiler takes a minute for loops after a discard.
layout(binding = 4) uniform sampler2D hit_depth;   // of raycast.frag
struct Hit {
  vec3 p, world;         // index, and the same point in the world
  vec3 normal, to_eye;   // world, unit length
  bool is_face;          // on a face of the box or a cut
  bool is_drawn;         // false: the other level of a bone in two is in front
#ifdef FOG
  float depth;           // view depth [m]
#endif
};

Hit hit_here() {
  vec2 ndc = 2.0 * gl_FragCoord.xy / lens.zw - 1.0;
  vec3 direction_index = forward_index.xyz + ndc.x * right_index.xyz + ndc.y * up_index.xyz;
  vec3 direction_world = forward_world.xyz + ndc.x * right_world.xyz + ndc.y * up_world.xyz;
  float found = texelFetch(hit_depth, ivec2(gl_FragCoord.xy), 0).r;
  Hit hit;
  hit.is_drawn = true;
#ifdef HOLE
  hit.is_drawn = abs(found) < 1e6;
#endif
#ifdef DETAIL
  hit.is_drawn = abs(found) > 1e6;
  found /= kOfDetail;
#endif
  float t = abs(found);
  hit.is_face = found < 0.0;
#ifdef FOG
  hit.depth = t;
#endif
  hit.p = eye_index.xyz + t * direction_index;
  hit.world = eye_world.xyz + t * direction_world;
  hit.to_eye = -normalize(direction_world);
  hit.normal = hit.is_face ? visible_span(direction_index, direction_world).normal : surface_normal(hit.p, hit.to_eye);
  return hit;
}
