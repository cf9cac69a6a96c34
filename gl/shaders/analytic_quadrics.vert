// Draws a bounding box for each sphere or disk, as an instance: the faces where rays leave it, which are in
// front of a camera inside of the box, too.
#include "gl/shaders/analytic_camera.glsl"
#include "gl/shaders/analytic_tables.glsl"

uniform bool look_through;  // emitters are not drawn

flat out int index;

void main() {
  index = gl_InstanceID;
  Quadric q = quadric_at(index);
  int side = gl_VertexID / 6, corner = gl_VertexID - 6 * side, axis = side / 2;
  vec3 half_size = vec3(1.001 * q.radius);
  float toward = (side & 1) == 0 ? -1.0 : 1.0;
  float u = (corner == 1 || corner == 2 || corner == 4) ? 1.0 : -1.0;
  float v = (corner == 2 || corner == 4 || corner == 5) ? 1.0 : -1.0;
  vec3 at = axis == 0 ? vec3(toward, u, v) : (axis == 1 ? vec3(v, toward, u) : vec3(u, v, toward));
  float beyond = toward * (axis == 0 ? q.center.x : (axis == 1 ? q.center.y : q.center.z));
  bool leaves = -beyond < half_size.x;
  leaves = leaves && !(look_through && q.light >= 0);
  gl_Position = leaves ? project(at * half_size + q.center) : vec4(2.0, 2.0, 2.0, 1.0);
}
