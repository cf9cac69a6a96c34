// Which triangle, and how deep: from its plane rather than from what the rasteriser interpolates, whose error
// would be that of a corner far away.
#include "gl/shaders/analytic_camera.glsl"

flat in int primitive;
flat in vec3 plane;
layout(location = 0) out int id;

void main() {
  float inverse_depth = dot(plane, pixel_direction(ivec2(gl_FragCoord.xy)));
  if (!(inverse_depth * far_clip >= 1.0)) discard;
  id = primitive;
  gl_FragDepth = depth_value(inverse_depth);
}
