// ID and depth of the sphere or disk.
#include "gl/shaders/analytic_camera.glsl"
#include "gl/shaders/analytic_tables.glsl"

uniform int triangle_count;
flat in int index;
layout(location = 0) out int id;

void main() {
  vec3 d = pixel_direction(ivec2(gl_FragCoord.xy));
  float along = length(d);
  float t = intersect_quadric(quadric_at(index), near_clip * d, d / along);
  float depth = near_clip + t / along;
  if (!(t > 0.0) || !(depth <= far_clip)) discard;
  id = triangle_count + index;
  gl_FragDepth = depth_value(1.0 / depth);
}
