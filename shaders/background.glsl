// A soft vertical gradient, darker at the top so that bone stands out. y: 0 bottom .. 1 top.
vec3 background(float y) { return mix(vec3(0.60, 0.65, 0.70), vec3(0.19, 0.24, 0.30), smoothstep(-0.1, 1.0, y)); }
