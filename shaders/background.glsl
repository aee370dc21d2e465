// A vertical gradient of the background. y: 0 bottom .. 1 top.
vec3 background(float y) {
#ifdef FOG
  return fog.rgb;   // far beyond the focus
#else
  vec3 far = mix(background_bottom.rgb, background_top.rgb, smoothstep(-0.1, 1.0, y));
#ifdef TABLE
  // A round table that fades into the gradient. Its shadows are bells: one under what lies there, one cast by the light.
  vec2 ndc = 2.0 * gl_FragCoord.xy / lens.zw - 1.0;
  vec3 way = forward_world.xyz + ndc.x * right_world.xyz + ndc.y * up_world.xyz;
  float fall = min(dot(table.xyz, way), -1e-6);
  float t = (table.w - dot(table.xyz, eye_world.xyz)) / fall;
  vec3 p = eye_world.xyz + t * way;
  vec2 at = vec2(dot(table_x.xyz, p) - table_x.w, dot(table_y.xyz, p) - table_y.w);
  vec2 thrown = at - table_cast.xy;
  float shade = (1.0 - 0.55 * exp(-1.5 * dot(at, at))) * (1.0 - 0.35 * exp(-1.1 * dot(thrown, thrown)));
  float share = t > 0.0 ? 1.0 - smoothstep(1.6, 4.5, length(at)) : 0.0;
  return mix(far, table_color.rgb * shade, share);
#else
  return far;
#endif
#endif
}
