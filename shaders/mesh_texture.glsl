// Colours of a textured bone ([TellesONeill10] section 3.3: a 2D image on the uncut surface, a 3D one where bone was cut). No seams: the 2D
// image is projected along three axes and blended by the normal. Which axes and at what scale: rows from the bone frame [m] to repeats.
layout(std140, binding = 1) uniform Textures {
  vec4 exterior_rows[3];
  vec4 interior_rows[3];
  vec4 texel_rates;   // x, y: texels per metre of exterior and interior
};

// Level of detail of a texture: texels below one pixel, at view depth t, square on.
float level_of(float texels_a_metre, float t) {
  return max(log2(texels_a_metre * t * 2.0 * length(right_world.xyz) / lens.z), 0.0);
}

vec3 texture_place(vec4 rows[3], vec3 p) {
  vec4 at = vec4(p, 1.0);
  return vec3(dot(rows[0], at), dot(rows[1], at), dot(rows[2], at));
}

#ifdef EXTERIOR
layout(binding = 2) uniform sampler2D exterior_image;

// p, n: bone frame. The weights are the fourth powers of the normal's components: within 18 degrees of an axis the blend is 1 to 1 %.
vec3 exterior_color(vec3 p, vec3 n, float t) {
  vec3 at = texture_place(exterior_rows, p);
  vec3 w = vec3(dot(exterior_rows[0].xyz, n), dot(exterior_rows[1].xyz, n), dot(exterior_rows[2].xyz, n));
  w /= length(w);
  w *= w;
  w *= w;
  float level = level_of(texel_rates.x, t);
  return (w.x * textureLod(exterior_image, at.yz, level).rgb + w.y * textureLod(exterior_image, at.xz, level).rgb +
          w.z * textureLod(exterior_image, at.xy, level).rgb) / (w.x + w.y + w.z);
}
#endif

#ifdef INTERIOR
layout(binding = 3) uniform sampler3D interior_image;

vec3 interior_color(vec3 p, float t) {
  return textureLod(interior_image, texture_place(interior_rows, p), level_of(texel_rates.y, t)).rgb;
}
#endif
