// Uniforms of one frame; mirrors FrameBlock in app/render/frame_block.h (std140, vec4 only, so that no padding rule applies).
layout(std140, binding = 0) uniform Frame {
  vec4 eye_index;              // camera in index coordinates
  vec4 forward_index;          // index displacement per metre of view depth
  vec4 right_index;            // index displacement per unit of normalised device x, y at view depth 1 m
  vec4 up_index;
  vec4 eye_world;              // camera in world coordinates [m]
  vec4 forward_world;
  vec4 right_world;
  vec4 up_world;
  vec4 index_rows[3];          // row a: gradient of index coordinate a in world [1/m]
  vec4 world_from_bone[3];     // columns of the rotation
  vec4 dims;                   // xyz voxels; w: step [voxels]
  vec4 light;                  // xyz towards the light, unit length, world; w: bisections
  vec4 light_terms;            // ambient, diffuse, headlight fill, voxels of this volume per voxel of the bone
  vec4 cut;                    // xyz normal (world, unit length), w offset [m]; points with dot(normal, p) > offset are cut away
  vec4 lens;                   // near [m], far [m], width, height [pixels]
  vec4 edges;                  // voxel edges [m], longest in w
  mat4 clip_from_tool;
  mat4 world_from_tool;
  mat4 clip_from_index;
  mat4 world_from_index;
  vec4 slices;                 // axis 0..2, count, how many of them lie beyond the eye along the axis, length an opacity holds over [m]
  vec4 background_bottom;      // rgb; w: blocks of w x w rays, of one pixel, share the samples of ambient occlusion
  vec4 background_top;
  // A large bone is two volumes: the whole at coarser voxels (HOLE) and a part at its own voxels (DETAIL). Otherwise these are 0, part.w 1.
  vec4 hole_lo;                // HOLE, index: the box that rays skip, since the detail is drawn there; w: 1
  vec4 hole_hi;                // w: bone voxels per voxel of this volume
  vec4 part;                   // DETAIL: xyz bone voxel at index 0; w: voxels of this volume per voxel of the whole one
  vec4 whole_dims;             // DETAIL: xyz voxels of the whole volume
  vec4 blend;                  // DETAIL: x, y [voxels]: up to x from its faces the part equals the whole, from x + y on it has its own texels
  vec4 table;                  // TABLE: xyz normal, w offset [m] of its plane, world
  vec4 table_x;                // TABLE: xyz times a point less w: its place from the middle of what lies there, in half widths
  vec4 table_y;
  vec4 table_cast;             // TABLE: x, y: the middle of its shadow in these units
  vec4 table_color;
  vec4 changed_lo;             // index: the box outside which no look-up reads a texel that has changed since the last picture
  vec4 changed_hi;
  mat4 clip_from_bone;         // of the skin
  mat4 world_from_bone_at;     // with the translation
  vec4 skin;                   // rgb; w: opacity square on
  vec4 fog;                    // FOG: rgb
  vec4 focus;                  // FOG: x: view depth of the plane without fog [m], y: 1 / depth of the fog [1/m]
  mat4 light_from_world;       // TOOL_SHADOW: world to -1..1 across the light and away from it, around the tool
};

// Factor of the hit depths of a detail, which distinguishes them from those of the whole volume. A power of two changes no bit of a float.
const float kOfDetail = 1099511627776.0;

// View depth [m] to the depth buffer's 0..1 and back.
float depth_from_view(float t) { return lens.y / (lens.y - lens.x) * (1.0 - lens.x / t); }
float view_from_depth(float depth) { return lens.x / (1.0 - depth * (lens.y - lens.x) / lens.y); }
