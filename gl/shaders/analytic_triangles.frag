// ID and depth of the triangle. The depth is computed from its plane: the rasteriser's interpolation would
// have the error of corners that are far away.
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
