// A vertical gradient of the background. y: 0 bottom .. 1 top.
vec3 background(float y) { return mix(background_bottom.rgb, background_top.rgb, smoothstep(-0.1, 1.0, y)); }
