// What the cases of `penumbra stress` compute with the kernels: one function over all of them, in portable
// source, so that each instruction set and each OpenCL device is asked the very same question. Numbers go in
// and come out as doubles, which hold every float exactly. FEATURES and LANES come from the build.
#ifndef PENUMBRA_STRESS_QUANTITIES_H
#define PENUMBRA_STRESS_QUANTITIES_H
#include "kernels/block/block_accumulate.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/camera/lens_camera.h"
#include "kernels/light/light.h"
#include "kernels/light/mis.h"
#include "kernels/light/projected_triangle.h"
#include "kernels/polygon/polygon_light.h"
#include "kernels/sampler/filter.h"
#include "kernels/sampler/sampler.h"
#include "scheduler/stress/quantity_list.h"

PENUMBRA_NAMESPACE_BEGIN

FN float in_f(GLOBAL const double* in, int i) { return (float)in[i]; }
FN uint in_u(GLOBAL const double* in, int i) { return (uint)in[i]; }
FN vec3 in_v(GLOBAL const double* in, int i) {
  return make_vec3((float)in[i], (float)in[i + 1], (float)in[i + 2]);
}
FN void out_v(GLOBAL double* out, int i, vec3 v) {
  out[i] = v.x;
  out[i + 1] = v.y;
  out[i + 2] = v.z;
}
FN void set_v(GLOBAL vec3* to, vec3 v) {
  to->x = v.x;
  to->y = v.y;
  to->z = v.z;
}

/// One record of each table, in scratch memory: what a function that takes a scene may read. Nothing is in
/// it.
FN Scene scratch_scene(GLOBAL uint* scratch) {
  for (int i = 0; i < 2048; i++) scratch[i] = 0u;
  Scene s;
#define POINT_AT_ZEROS(s, name, record, least, what) s.name = (GLOBAL const record*)scratch;
  SCENE_TABLES(POINT_AT_ZEROS, s)
#undef POINT_AT_ZEROS
  s.normals = (GLOBAL const VertexNormals*)(scratch + 64);
  s.quadrics = (GLOBAL const Quadric*)(scratch + 128);
  s.materials = (GLOBAL const Material*)(scratch + 192);
  s.lights = (GLOBAL const Light*)(scratch + 256);
  s.polygons = (GLOBAL const Polygon*)(scratch + 320);
  s.polygon_corners = (GLOBAL const PolygonCorner*)(scratch + 384);
  s.filter_table = (GLOBAL const float*)(scratch + 1024);
  s.header.features = FEATURE_ALL;
  s.header.families = EVERY_FAMILY;
  s.header.light_kinds = ALL_LIGHT_KINDS;
  s.header.environment = -1;
  s.header.tables.triangles.count = 1;
  s.header.tables.quadrics.count = 0;
  s.header.tables.lights.count = 1;
#ifdef EXTERNAL_TRACER
  s.tracer.context = 0;
  s.tracer.intersect = 0;
  s.tracer.occlude = 0;
#endif
  return s;
}

/// In: position, normal, mirror direction, exponent (negative: no lobe), two-sided; number of corners, then
/// of each x, y, z and whether it starts a loop. Out: irradiance, lobe; then the largest difference of a
/// lane's from those of lane 0, which had the same question.
STAGE void polygon_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  const Scene scene = scratch_scene(scratch);
  GLOBAL Polygon* polygon = (GLOBAL Polygon*)(scratch + 320);
  GLOBAL PolygonCorner* corners = (GLOBAL PolygonCorner*)(scratch + 384);
  polygon->two_sided = (int)in[10];
  polygon->corner_count = (int)in[11];
  for (int i = 0; i < polygon->corner_count; i++) {
    set_v(&corners[i].p, in_v(in, 12 + 4 * i));
    corners[i].starts = (int)in[15 + 4 * i];
  }
  Receivers r;
  for (int j = 0; j < LANES; j++) {
    r.px[j] = in[0];
    r.py[j] = in[1];
    r.pz[j] = in[2];
    r.nx[j] = in[3];
    r.ny[j] = in[4];
    r.nz[j] = in[5];
    r.wx[j] = in[6];
    r.wy[j] = in[7];
    r.wz[j] = in[8];
    r.exponent[j] = in[9];
#if HAS(LTC)
    r.tx[j] = r.ty[j] = r.tz[j] = 0.0;
    r.inverse_x[j] = r.inverse_y[j] = r.shift[j] = 0.0;
#endif
  }
  double irradiance[LANES], lobe[LANES];
  polygon_terms(&scene, &r, 0, irradiance, lobe);
  out[0] = irradiance[0];
  out[1] = lobe[0];
  out[2] = 0.0;
  for (int j = 1; j < LANES; j++)
    out[2] = max_d(out[2], FABS_D(irradiance[j] - irradiance[0]) + FABS_D(lobe[j] - lobe[0]));
}

/// In: three vertices relative to the point, u, v. Out: direction, solid angle.
STAGE void spherical_triangle_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const SphericalTriangle t = spherical_triangle(in_v(in, 0), in_v(in, 3), in_v(in, 6));
  out_v(out, 0, sample_spherical_triangle(t, in_f(in, 9), in_f(in, 10)));
  out[3] = t.solid_angle;
}

/// In: corner, next, previous, u, v. Out: direction, solid angle.
STAGE void spherical_rectangle_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const SphericalRectangle r = spherical_rectangle(in_v(in, 0), in_v(in, 3), in_v(in, 6));
  out_v(out, 0, sample_spherical_rectangle(r, in_f(in, 9), in_f(in, 10)));
  out[3] = r.solid_angle;
}

/// In: three vertices in the receiver's frame, u, v; an axis w, size N of a grid. Out: direction, projected
/// solid angle (0: not sampled); mean of w.u over the N x N samples at the middles of the cells of (u, v);
/// how many of them are not unit vectors above the horizon.
STAGE void projected_triangle_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const ProjectedPolygon p = project_triangle(in_v(in, 0), in_v(in, 3), in_v(in, 6));
  out_v(out, 0, sample_projected_polygon(p, in_f(in, 9), in_f(in, 10)));
  out[3] = p.area;
  const vec3 w = in_v(in, 11);
  const int size = (int)in[14];
  double sum = 0.0, bad = 0.0;
  for (int i = 0; i < size; i++) {
    for (int k = 0; k < size; k++) {
      const vec3 d =
          sample_projected_polygon(p, ((float)i + 0.5f) / (float)size, ((float)k + 0.5f) / (float)size);
      sum += dot3(w, d);
      bad += ((FABS(dot3(d, d) - 1.0f) < 1e-5f) & (d.z >= 0.0f)) ? 0.0 : 1.0;
    }
  }
  out[4] = sum / max_d((double)size * (double)size, 1.0);
  out[5] = bad;
}

/// In: reflectances of the diffuse and the Phong lobe, exponent.
FN Closure closure_in(GLOBAL const double* in) {
  Closure c = black_closure();
  c.family = FAMILY_PHONG;
  c.diffuse = make_vec3(in_f(in, 0), in_f(in, 0), in_f(in, 0));
  c.specular = make_vec3(in_f(in, 1), in_f(in, 1), in_f(in, 1));
  c.exponent = in_f(in, 2);
  return c;
}

/// In: closure, normal, wo, wi. Out: f cos, pdf.
STAGE void bsdf_value_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const BsdfValue value = eval_bsdf(0, closure_in(in), in_v(in, 3), in_v(in, 6), in_v(in, 9));
  out[0] = value.f_cos.x;
  out[1] = value.pdf;
}

/// In: closure, normal, wo, u, v, choice. Out: direction, weight, pdf.
STAGE void bsdf_sample_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const BsdfSample s =
      sample_bsdf(0, closure_in(in), in_v(in, 3), in_v(in, 6), in_f(in, 9), in_f(in, 10), in_f(in, 11));
  out_v(out, 0, s.wi);
  out[3] = s.weight.x;
  out[4] = s.pdf;
}

/// In: closure, normal, wo, size N of a grid. Out: mean weight of the N x N samples at the middles of the
/// cells of (u, v), each with either lobe as often as it is chosen: the albedo; largest weight; how many
/// directions are not unit vectors.
STAGE void bsdf_albedo_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const Closure c = closure_in(in);
  const double share = (double)phong_lobe_share(c);
  const vec3 n = in_v(in, 3), wo = in_v(in, 6);
  const int size = (int)in[9];
  double sum = 0.0, largest = 0.0, bad = 0.0;
  for (int i = 0; i < size; i++) {
    for (int k = 0; k < size; k++) {
      const float u = ((float)i + 0.5f) / (float)size, v = ((float)k + 0.5f) / (float)size;
      const BsdfSample a = sample_bsdf(0, c, n, wo, u, v, 0.0f);
      const BsdfSample b = sample_bsdf(0, c, n, wo, u, v, ONE_MINUS_EPSILON);
      sum += share * a.weight.x + (1.0 - share) * b.weight.x;
      largest = max_d(largest, max_d(a.weight.x, b.weight.x));
      const float length2 = dot3(a.wi, a.wi);
      bad += FABS(length2 - 1.0f) < 1e-5f ? 0.0 : 1.0;
    }
  }
  out[0] = sum / ((double)size * (double)size);
  out[1] = largest;
  out[2] = bad;
}

/// In: family, variant, reflectances of base and lobe, refractive index, internal reflectance (of a conductor
/// its absorption), roughness along and across, exponent.
FN Closure mixture_in(GLOBAL const double* in) {
  Closure c = black_closure();
  c.family = (int)in[0];
  c.variant = (int)in[1];
  c.diffuse = make_vec3(in_f(in, 2), in_f(in, 2), in_f(in, 2));
  c.specular = make_vec3(in_f(in, 3), in_f(in, 3), in_f(in, 3));
  c.transmitted = c.specular;
  c.ior = in_f(in, 4);
  c.eta = make_vec3(c.ior, c.ior, c.ior);
  c.internal = in_f(in, 5);
  c.k = make_vec3(c.internal, c.internal, c.internal);
  c.alpha_u = in_f(in, 6);
  c.alpha_v = in_f(in, 7);
  c.exponent = in_f(in, 8);
  return c;
}

/// In: closure, wo, wi about the z axis. Out: f cos, pdf.
STAGE void mixture_value_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const vec3 z = make_vec3(0.0f, 0.0f, 1.0f);
  const BsdfValue value = eval_bsdf(0, mixture_in(in), z, in_v(in, 9), in_v(in, 12));
  out[0] = value.f_cos.x;
  out[1] = value.pdf;
}

/// In: closure, wo about the z axis, size N of a grid. Out: largest weight of N x N samples by either lobe;
/// how many have a weight or a direction that is none.
STAGE void mixture_samples_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const vec3 z = make_vec3(0.0f, 0.0f, 1.0f);
  const Closure c = mixture_in(in);
  const int size = (int)in[12];
  const bool transmits = (families_with(TRANSMITS) >> c.family & 1u) != 0u;
  double largest = 0.0, bad = 0.0;
  for (int i = 0; i < size * size; i++) {
    const float u = ((float)(i / size) + 0.5f) / (float)size, v = ((float)(i % size) + 0.5f) / (float)size;
    for (int lobe = 0; lobe < 2; lobe++) {
      const BsdfSample s = sample_bsdf(0, c, z, in_v(in, 9), u, v, lobe == 0 ? 0.0f : ONE_MINUS_EPSILON);
      const bool unit = FABS(dot3(s.wi, s.wi) - 1.0f) < 1e-5f;
      const bool found = s.pdf > 0.0f;
      const bool good = (s.weight.x >= 0.0f) & (s.weight.x < 1e30f) & (transmits | (s.wi.z > 0.0f));
      bad += (unit & (found ? good : true)) ? 0.0 : 1.0;
      largest = max_d(largest, found ? s.weight.x : 0.0);
    }
  }
  out[0] = largest;
  out[1] = bad;
}

/// In: cosine, refractive index, absorption. Out: reflectance of a dielectric, cosine beyond; reflectance of
/// a conductor.
STAGE void fresnel_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const DielectricFresnel f = dielectric_fresnel(in_f(in, 0), in_f(in, 1));
  out[0] = f.reflectance;
  out[1] = f.cosine;
  out[2] = conductor_reflectance(in_f(in, 0), in_f(in, 1), in_f(in, 2));
}

/// In: 0 cosine, 1 uniform hemisphere, 2 uniform sphere; normal, u, v. Out: direction.
STAGE void direction_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const int kind = (int)in[0];
  const vec3 n = in_v(in, 1);
  const float u = in_f(in, 4), v = in_f(in, 5);
  const vec3 cosine = sample_cosine_hemisphere(n, u, v), uniform = sample_uniform_hemisphere(n, u, v);
  const vec3 sphere = sample_uniform_sphere(u, v);
  out_v(out, 0, kind == 0 ? cosine : (kind == 1 ? uniform : sphere));
}

/// In: normal, vector. Out: the vector in the normal's frame; and how far taking it back misses it.
STAGE void frame_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const vec3 n = in_v(in, 0), v = in_v(in, 3);
  const vec3 inside = to_frame(n, v), again = from_frame(n, inside.x, inside.y, inside.z);
  out_v(out, 0, inside);
  out[3] = length3(sub(again, v));
}

/// In: SAMPLER_*, samples per pixel, seed, pixel x and y, first sample, number of samples, pair. Out: least
/// u, greatest u, least v, greatest v, mean u, mean v; how many cells of the grid with as many cells as
/// samples hold one (for up to 65536 samples, columns by strata_columns).
STAGE void sampler_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  const int kind = (int)in[0];
  const uint spp = in_u(in, 1), pixel = pixel_hash(in_u(in, 2), in_u(in, 3), in_u(in, 4));
  const uint first = in_u(in, 5), count = in_u(in, 6), pair = in_u(in, 7);
  const uint columns = strata_columns(count), rows = count / columns;
  for (int i = 0; i < 2048; i++) scratch[i] = 0u;
  double low_u = 2.0, low_v = 2.0, high_u = -1.0, high_v = -1.0, sum_u = 0.0, sum_v = 0.0;
  for (uint i = 0; i < count; i++) {
    float u, v;
    if (kind == SAMPLER_STRATIFIED)
      stratified_pair(pixel, first + i, pair, spp, &u, &v);
    else if (kind == SAMPLER_HALTON)
      halton_pair(pixel, first + i, pair, &u, &v);
    else if (kind == SAMPLER_INDEPENDENT)
      independent_pair(pixel, first + i, pair, &u, &v);
    else
      sobol_pair(pixel, first + i, pair, &u, &v);
    low_u = min_d(low_u, u);
    low_v = min_d(low_v, v);
    high_u = max_d(high_u, u);
    high_v = max_d(high_v, v);
    sum_u += u;
    sum_v += v;
    const uint cell = (uint)(u * (float)columns) + columns * (uint)(v * (float)rows);
    if (cell < 65536u) scratch[cell >> 5] |= 1u << (cell & 31u);
  }
  double hit = 0.0;
  for (uint i = 0; i < 65536u; i++) hit += (scratch[i >> 5] >> (i & 31u)) & 1u ? 1.0 : 0.0;
  out[0] = low_u;
  out[1] = high_u;
  out[2] = low_v;
  out[3] = high_v;
  out[4] = sum_u / (double)count;
  out[5] = sum_v / (double)count;
  out[6] = hit;
}

/// In: index, base. Out: the radical inverse.
STAGE void radical_inverse_quantity(GLOBAL const double* in, GLOBAL double* out) {
  out[0] = radical_inverse(in_u(in, 0), in_u(in, 1));
}

/// In: centre and half-width of an octahedron, origin of the rays, number of rays. Each goes through a random
/// point of one of its edges, or through a vertex. Out: how many hit none of its faces in front.
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

/// In: triangle, origin of the rays, number of rays. Each goes through a random point of the triangle. Out:
/// the largest distance of a position from the triangle's plane, and the least and the greatest height above
/// it of an origin that leaves it on the ray's side; all three in units of the error that the surface states.
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
    // The error may be 0: then the position has to be exact.
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

/// In: k1, k2, reach, distance from the axis on a distorted film. Out: the same without distortion.
STAGE void undistort_quantity(GLOBAL const double* in, GLOBAL double* out) {
  Camera camera;
  camera.x = make_vec3(1.0f, 0.0f, 0.0f);
  camera.y = make_vec3(0.0f, 1.0f, 0.0f);
  camera.k1 = in_f(in, 0);
  camera.k2 = in_f(in, 1);
  camera.reach = in_f(in, 2);
  float x[LANES], y[LANES];
  for (int j = 0; j < LANES; j++) {
    x[j] = in_f(in, 3);
    y[j] = 0.0f;
  }
  undistort(camera, x, y);
  out[0] = x[0];
}

/// In: HEURISTIC_*, density of the strategy, of the other. Out: weight.
STAGE void mis_quantity(GLOBAL const double* in, GLOBAL double* out) {
  out[0] = mis_weight((int)in[0], in_f(in, 1), in_f(in, 2));
}

/// In: centre and radius of a sphere light, point, its normal, u, v. Out: direction, density,
/// sphere_light_pdf of that direction, length of the shadow ray, or a negative number.
STAGE void sphere_light_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  const Scene scene = scratch_scene(scratch);
  GLOBAL Light* light = (GLOBAL Light*)(scratch + 256);
  const float radius = in_f(in, 3);
  set_v(&light->radiance, make_vec3(1.0f, 1.0f, 1.0f));
  set_v(&light->p0, in_v(in, 0));
  set_v(&light->p2, make_vec3(radius, 1.0f, 0.0f));
  light->area = 4.0f * PI_F * radius * radius;
  light->sampling = EMITTER_SOLID_ANGLE;
  light->polygon = -1;
  light->pmf = light->alias_threshold = 1.0f;
  light->kind = LIGHT_SPHERE;
  Surface s = surface_in_medium(in_v(in, 4));
  s.geometric = s.shading = in_v(in, 7);
  s.error = POSITION_ERROR * dot3(abs3(s.geometric), abs3(s.p));
  const LightReceiver r = receiver_of(s);
  const LightSample sample =
      sample_sphere_light(&scene, 0, r, in_f(in, 10), in_f(in, 11), no_light_sampling(), 0u);
  out_v(out, 0, sample.wi);
  out[3] = sample.pdf;
  FoundLight found;
  found.from = r.p;
  found.wi = sample.wi;
  found.distance = sample.tmax;
  found.cosine = 1.0f;  // of no account for a cone
  out[4] = sphere_light_pdf(&scene, light, found, 0u);
  out[5] = sample.tmax;
}

/// In: number of samples, base, step, period: sample i is base + step (i % period). Out: mean, sum of squared
/// deviations.
STAGE void accumulate_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  GLOBAL float* values = (GLOBAL float*)scratch;
  const int count = (int)in[0], period = (int)in[3];
  for (int i = 0; i < count; i++) values[i] = in_f(in, 1) + in_f(in, 2) * (float)(i % period);
  GLOBAL float* statistics = values + count + LANES;
  accumulate_field(values, 1, 1, count, statistics, statistics + 1);
  out[0] = statistics[0];
  out[1] = (double)statistics[1] * statistics[1] * count;
}

/// In: MATH_*, x, y. Out: the function's value.
STAGE void math_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const int function = (int)in[0];
  const float x = in_f(in, 1), y = in_f(in, 2);
  float sine, cosine;
  sincos_2pi(clamp_f(x, -2.0f, 2.0f), &sine, &cosine);
  if (function == MATH_EXP) out[0] = exp_f(x);
  if (function == MATH_EXPM1) out[0] = expm1_f(x);
  if (function == MATH_LOG) out[0] = log_f(x);
  if (function == MATH_LOG1P) out[0] = log1p_f(x);
  if (function == MATH_ATAN2) out[0] = atan2_f(y, x);
  if (function == MATH_SIN_2PI) out[0] = sine;
  if (function == MATH_COS_2PI) out[0] = cosine;
}

/// In: FILTER_BOX or FILTER_TENT, u. Out: offset.
STAGE void filter_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  const Scene scene = scratch_scene(scratch);
  out[0] = sample_filter((int)in[0], scene.filter_table, in_f(in, 1)).x;
}

/// Answers one question: QUANTITY_INPUTS numbers in, QUANTITY_OUTPUTS out, with QUANTITY_SCRATCH words.
STAGE void quantity(int id, GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  for (int i = 0; i < QUANTITY_OUTPUTS; i++) out[i] = 0.0;
  if (id == QUANTITY_POLYGON) polygon_quantity(in, out, scratch);
  if (id == QUANTITY_SPHERICAL_TRIANGLE) spherical_triangle_quantity(in, out);
  if (id == QUANTITY_SPHERICAL_RECTANGLE) spherical_rectangle_quantity(in, out);
  if (id == QUANTITY_PROJECTED_TRIANGLE) projected_triangle_quantity(in, out);
  if (id == QUANTITY_BSDF_VALUE) bsdf_value_quantity(in, out);
  if (id == QUANTITY_BSDF_SAMPLE) bsdf_sample_quantity(in, out);
  if (id == QUANTITY_BSDF_ALBEDO) bsdf_albedo_quantity(in, out);
  if (id == QUANTITY_DIRECTION) direction_quantity(in, out);
  if (id == QUANTITY_FRAME) frame_quantity(in, out);
  if (id == QUANTITY_SAMPLER) sampler_quantity(in, out, scratch);
  if (id == QUANTITY_RADICAL_INVERSE) radical_inverse_quantity(in, out);
  if (id == QUANTITY_WATERTIGHT) watertight_quantity(in, out);
  if (id == QUANTITY_SURFACE) surface_quantity(in, out, scratch);
  if (id == QUANTITY_SPHERE) sphere_quantity(in, out);
  if (id == QUANTITY_CAMERA) camera_quantity(in, out);
  if (id == QUANTITY_MIS) mis_quantity(in, out);
  if (id == QUANTITY_SPHERE_LIGHT) sphere_light_quantity(in, out, scratch);
  if (id == QUANTITY_ACCUMULATE) accumulate_quantity(in, out, scratch);
  if (id == QUANTITY_MATH) math_quantity(in, out);
  if (id == QUANTITY_FILTER) filter_quantity(in, out, scratch);
  if (id == QUANTITY_MIXTURE_VALUE) mixture_value_quantity(in, out);
  if (id == QUANTITY_MIXTURE_SAMPLES) mixture_samples_quantity(in, out);
  if (id == QUANTITY_FRESNEL) fresnel_quantity(in, out);
  if (id == QUANTITY_UNDISTORT) undistort_quantity(in, out);
}

PENUMBRA_NAMESPACE_END
#endif
