// The tables of the device scene, packed by gl/analytic_tables.cpp; positions are relative to the camera.
uniform usamplerBuffer triangles;     // p0, front; p1, back; p2, light; normals, polygon, 0, 0
uniform usamplerBuffer quadrics;      // center, radius; normal, orientation; kind, front, back, light
uniform samplerBuffer vertex_normals;  // n0, 0; n1, 0; n2, 0

#define QUADRIC_SPHERE 0
#define QUADRIC_DISK 1

struct TriangleCorners {
  vec3 p0, p1, p2;
};

TriangleCorners triangle_corners(int index) {
  TriangleCorners t;
  t.p0 = uintBitsToFloat(texelFetch(triangles, 4 * index).xyz) - camera_origin;
  t.p1 = uintBitsToFloat(texelFetch(triangles, 4 * index + 1).xyz) - camera_origin;
  t.p2 = uintBitsToFloat(texelFetch(triangles, 4 * index + 2).xyz) - camera_origin;
  return t;
}

struct Quadric {
  vec3 center, normal;
  float radius, orientation;
  int kind, front, back, light;
};

Quadric quadric_at(int index) {
  uvec4 a = texelFetch(quadrics, 3 * index), b = texelFetch(quadrics, 3 * index + 1);
  ivec4 c = ivec4(texelFetch(quadrics, 3 * index + 2));
  Quadric q;
  q.center = uintBitsToFloat(a.xyz) - camera_origin;
  q.radius = uintBitsToFloat(a.w);
  q.normal = uintBitsToFloat(b.xyz);
  q.orientation = uintBitsToFloat(b.w);
  q.kind = c.x;
  q.front = c.y;
  q.back = c.z;
  q.light = c.w;
  return q;
}

// Like intersect_sphere and intersect_disk of kernels/intersect/quadric.h; negative: no hit.
float intersect_quadric(Quadric q, vec3 o, vec3 d) {
  vec3 f = o - q.center;
  if (q.kind == QUADRIC_DISK) {
    float cosine = dot(q.normal, d);
    float t = cosine != 0.0 ? -dot(q.normal, f) / cosine : -1.0;
    vec3 from_center = f + t * d;
    return dot(from_center, from_center) <= q.radius * q.radius ? t : -1.0;
  }
  float b = -dot(f, d);
  vec3 closest = f + b * d;
  float discriminant = q.radius * q.radius - dot(closest, closest);
  float root = sqrt(max(discriminant, 0.0));
  float far_root = b >= 0.0 ? b + root : b - root;
  float other = far_root != 0.0 ? (dot(f, f) - q.radius * q.radius) / far_root : 0.0;
  float low = min(other, far_root), high = max(other, far_root);
  return discriminant >= 0.0 ? (low > 0.0 ? low : high) : -1.0;
}
