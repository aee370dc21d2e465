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
  vec4 light_terms;            // ambient, diffuse, headlight fill, 0
  vec4 cut;                    // xyz normal (world, unit length), w offset [m]; points with dot(normal, p) > offset are cut away
  vec4 lens;                   // near [m], far [m], width, height [pixels]
  vec4 edges;                  // voxel edges [m], longest in w
  mat4 clip_from_tool;
  mat4 world_from_tool;
  mat4 clip_from_index;
  mat4 world_from_index;
  vec4 slices;                 // axis 0..2, count, how many of them lie beyond the eye along the axis, length an opacity holds over [m]
  vec4 background_bottom;      // rgb
  vec4 background_top;
};

// View depth [m] to the depth buffer's 0..1 and back.
float depth_from_view(float t) { return lens.y / (lens.y - lens.x) * (1.0 - lens.x / t); }
float view_from_depth(float depth) { return lens.x / (1.0 - depth * (lens.y - lens.x) / lens.y); }
