// Triangles without vertex attributes: three vertices each, by vertex number.
#include "gl/shaders/analytic_camera.glsl"
#include "gl/shaders/analytic_tables.glsl"

uniform bool look_through;  // emitters are not drawn

flat out int primitive;
flat out vec3 plane;  // times a direction: the inverse depth where the ray meets the triangle's plane

void main() {
  primitive = gl_VertexID / 3;
  TriangleCorners t = triangle_corners(primitive);
  int corner = gl_VertexID - 3 * primitive;
  bool emits = int(texelFetch(triangles, 4 * primitive + 2).w) >= 0;
  gl_Position = look_through && emits ? vec4(2.0, 2.0, 2.0, 1.0)
                                      : project(corner == 0 ? t.p0 : (corner == 1 ? t.p1 : t.p2));
  vec3 normal = cross(t.p1 - t.p0, t.p2 - t.p0);
  float height = dot(normal, t.p0);
  plane = height != 0.0 ? normal / height : vec3(0.0);
}
