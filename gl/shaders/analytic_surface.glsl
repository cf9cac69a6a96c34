// The surface where a ray meets a primitive, as in kernels/intersect/surface.h.
struct Surface {
  bool valid, front;
  vec3 p;        // relative to the camera
  vec3 geometric, shading;  // unit, on the camera's side
  int material;
  int light;    // or -1
  int polygon;  // index of its polygon light, or -1
};

Surface triangle_surface(int index, vec3 o, vec3 d) {
  TriangleCorners t = triangle_corners(index);
  vec3 e1 = t.p1 - t.p0, e2 = t.p2 - t.p0;
  vec3 normal = cross(e1, e2);
  // Moeller and Trumbore 1997.
  vec3 from = o - t.p0, p = cross(d, e2), q = cross(from, e1);
  float det = dot(e1, p), inverse = det != 0.0 ? 1.0 / det : 0.0;
  float b1 = dot(from, p) * inverse, b2 = dot(d, q) * inverse;
  Surface s;
  s.valid = true;
  s.front = dot(normal, d) < 0.0;
  // Relative to a corner the error scales with the triangle's size, relative to the ray's origin with the
  // distance.
  float along = dot(normal, d), distance = along != 0.0 ? -dot(normal, from) / along : 0.0;
  bool is_large = max(dot(e1, e1), dot(e2, e2)) > distance * distance;
  s.p = is_large ? o + distance * d : t.p0 + (b1 * e1 + b2 * e2);
  s.geometric = s.shading = normalize(normal);
  ivec2 more = ivec2(texelFetch(triangles, 4 * index + 3).xy);
  int normals = more.x;
  if (normals >= 0) {
    vec3 blend = (1.0 - b1 - b2) * texelFetch(vertex_normals, 3 * normals).xyz +
                 b1 * texelFetch(vertex_normals, 3 * normals + 1).xyz +
                 b2 * texelFetch(vertex_normals, 3 * normals + 2).xyz;
    if (dot(blend, blend) > 1e-12) s.shading = normalize(blend);
  }
  s.material = int(texelFetch(triangles, 4 * index + (s.front ? 0 : 1)).w);
  s.light = int(texelFetch(triangles, 4 * index + 2).w);
  s.polygon = more.y;
  return s;
}

Surface quadric_surface(int index, vec3 o, vec3 d) {
  Quadric q = quadric_at(index);
  vec3 at = o + intersect_quadric(q, o, d) * d;
  Surface s;
  s.valid = true;
  if (q.kind == QUADRIC_DISK) {
    s.p = at - dot(at - q.center, q.normal) * q.normal;
    s.shading = q.normal;
  } else {
    vec3 outward = normalize(at - q.center);
    s.p = q.center + q.radius * outward;
    s.shading = q.orientation * outward;
  }
  s.front = dot(s.shading, d) < 0.0;
  s.geometric = s.shading;
  s.material = s.front ? q.front : q.back;
  s.light = q.light;
  s.polygon = -1;
  return s;
}

// d is unit; a negative primitive means no hit.
Surface surface_at(int primitive, int triangle_count, vec3 o, vec3 d) {
  Surface s;
  s.valid = false;
  s.front = false;
  s.p = vec3(0.0);
  s.geometric = s.shading = vec3(0.0);
  s.material = 0;
  s.light = s.polygon = -1;
  if (primitive >= triangle_count)
    s = quadric_surface(primitive - triangle_count, o, d);
  else if (primitive >= 0)
    s = triangle_surface(primitive, o, d);
  float side = s.front ? 1.0 : -1.0;
  s.geometric *= side;
  s.shading *= side;
  if (dot(s.shading, d) >= 0.0 || dot(s.shading, s.geometric) <= 0.0) s.shading = s.geometric;
  return s;
}
