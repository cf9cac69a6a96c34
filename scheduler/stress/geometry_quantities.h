// Quantities of rays: intersection with primitives, and generation by cameras. See quantities.h.
#ifndef PENUMBRA_STRESS_GEOMETRY_QUANTITIES_H
#define PENUMBRA_STRESS_GEOMETRY_QUANTITIES_H
#include "kernels/camera/lens_camera.h"
#include "kernels/light/light.h"
#include "kernels/math/vec3_double.h"
#include "scheduler/stress/quantity_numbers.h"

PENUMBRA_NAMESPACE_BEGIN

/// In: centre and half-width of an octahedron, origin of the rays, number of rays. Each ray goes through a
/// random point of an edge, or through a vertex. Out: the number of rays that hit no front face (leaks).
STAGE void watertight_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const vec3 center = in_v(in, 0), origin = in_v(in, 4);
  const float size = in_f(in, 3);
  const uint rays = in_u(in, 7);
  vec3 corners[6];
  for (int k = 0; k < 3; k++) {
    const vec3 axis = make_vec3(k == 0 ? size : 0.0f, k == 1 ? size : 0.0f, k == 2 ? size : 0.0f);
    corners[2 * k] = sub(add(center, axis), origin);
    corners[2 * k + 1] = sub(sub(center, axis), origin);
  }
  double misses = 0.0;
  for (uint i = 0; i < rays; i++) {
    const uint h = hash_uint(i), g = hash_uint(h ^ 0x9e3779b9u);
    // Two corners that are not opposite.
    const uint axis = h % 3u, other = (axis + 1u + ((h >> 8) & 1u)) % 3u;
    const vec3 a = corners[2u * axis + ((h >> 9) & 1u)], b = corners[2u * other + ((h >> 10) & 1u)];
    const float t = (h >> 28) == 0u ? 0.0f : unit_float(g);
    const vec3 d = normalize3(add_scaled(a, t, sub(b, a)));
    const Shear shear = make_shear(d);
    bool hit = false;
    for (int f = 0; f < 8; f++) {
      const TriangleHit face = intersect_sheared(shear_point(shear, corners[f & 1]),
                                                 shear_point(shear, corners[2 + ((f >> 1) & 1)]),
                                                 shear_point(shear, corners[4 + ((f >> 2) & 1)]));
      hit = hit | (face.inside & (face.t > 0.0f) & (face.t < NO_LIMIT));
    }
    misses += hit ? 0.0 : 1.0;
  }
  out[0] = misses;
}

/// In: triangle, origin of the rays, number of rays. Each ray goes through a random point of the triangle.
/// Out: the largest distance of a hit point from the triangle's plane; the smallest and the largest height
/// above it of the origin of a ray that leaves on the ray's side. All three are in units of the surface's
/// stated error.
STAGE void surface_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  const Scene scene = scratch_scene(scratch);
  GLOBAL Triangle* t = (GLOBAL Triangle*)scratch;
  const vec3 p0 = in_v(in, 0), p1 = in_v(in, 3), p2 = in_v(in, 6), origin = in_v(in, 9);
  set_v(&t->p0, p0);
  set_v(&t->p1, p1);
  set_v(&t->p2, p2);
  t->light = t->normals = -1;
  const vec3d n = cross3_d(sub_d(widen3(p1), widen3(p0)), sub_d(widen3(p2), widen3(p0)));
  const double length = SQRT_D(dot3_d(n, n));
  const double side = dot3_d(n, sub_d(widen3(origin), widen3(p0))) < 0.0 ? -1.0 : 1.0;
  double farthest = 0.0, low = 1e300, high = -1e300;
  for (uint i = 0; i < in_u(in, 12); i++) {
    const float u = unit_float(hash_uint(i)), v = unit_float(hash_uint(i ^ 0x9e3779b9u));
    const float root = SQRT(u);
    const vec3 at = add(add(scale(p0, 1.0f - root), scale(p1, v * root)), scale(p2, root - v * root));
    const Surface s = surface_at(&scene, 0, origin, normalize3(sub(at, origin)));
    const vec3 leaving = leave_surface(s.p, s.geometric, s.error, s.geometric);
    // If the error is 0, the position must be exact.
    const double unit = length * max_d((double)s.error, 1e-200);
    const double off = dot3_d(n, sub_d(widen3(s.p), widen3(p0))) / unit;
    const double height = side * dot3_d(n, sub_d(widen3(leaving), widen3(p0))) / unit;
    farthest = max_d(farthest, FABS_D(off));
    low = min_d(low, height);
    high = max_d(high, height);
  }
  out[0] = farthest;
  out[1] = low;
  out[2] = high;
}

/// In: origin, unit direction, centre, radius. Out: distance to the sphere, or a negative number.
STAGE void sphere_quantity(GLOBAL const double* in, GLOBAL double* out) {
  out[0] = intersect_sphere(in_v(in, 0), in_v(in, 3), in_v(in, 6), in_f(in, 9));
}

/// In: size of the film, half its extent at distance 1; pixel, offset. Out: direction.
STAGE void camera_quantity(GLOBAL const double* in, GLOBAL double* out) {
  FilmParameters film;
  film.width = (int)in[0];
  film.height = (int)in[1];
  Camera camera;
  camera.origin = make_vec3(0.0f, 0.0f, 0.0f);
  camera.x = make_vec3(in_f(in, 2), 0.0f, 0.0f);
  camera.y = make_vec3(0.0f, in_f(in, 3), 0.0f);
  camera.z = make_vec3(0.0f, 0.0f, 1.0f);
  camera.near_clip = 0.01f;
  camera.far_clip = 1e4f;
  const Ray ray = camera_ray(camera, film, (int)in[4], (int)in[5], in_f(in, 6), in_f(in, 7));
  out_v(out, 0, ray.direction);
}

/// In: k1, k2, reach, distance from the axis on the distorted film. Out: the undistorted distance.
STAGE void undistort_quantity(GLOBAL const double* in, GLOBAL double* out) {
  Camera camera;
  camera.x = make_vec3(1.0f, 0.0f, 0.0f);
  camera.y = make_vec3(0.0f, 1.0f, 0.0f);
  camera.k1 = in_f(in, 0);
  camera.k2 = in_f(in, 1);
  camera.reach = in_f(in, 2);
  float d[LANES], x[LANES], y[LANES];
  for (int j = 0; j < LANES; j++) {
    d[j] = x[j] = in_f(in, 3);
    y[j] = 0.0f;
  }
  undistort(camera, d, x, y);
  out[0] = x[0];
}

PENUMBRA_NAMESPACE_END
#endif
