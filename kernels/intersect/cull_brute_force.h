// Culls the triangles of a small scene that a bundle of rays cannot meet. A bundle is LANES coherent rays:
// camera rays, or shadow rays from their hits to one light. Culling has a margin far above the rounding
// errors by which a ray may hit a triangle beside it, so the hits are the same as if every triangle were
// tested.
#ifndef PENUMBRA_CULL_BRUTE_FORCE_H
#define PENUMBRA_CULL_BRUTE_FORCE_H
#include "kernels/intersect/bvh_limits.h"
#include "kernels/math/frame.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// LANES rays, in arrays that stay in the L1 cache. On return `tmax` is the distance of the hit and `hit` its
/// primitive, or -1.
typedef struct {
  float ox[LANES], oy[LANES], oz[LANES], dx[LANES], dy[LANES], dz[LANES];
  float tmax[LANES];  ///< at most 0: there is no ray
  int skip[LANES];
  int hit[LANES];
} RayLanes;

#if LANES > 1
  // The smallest cosine between a bundle's rays and its axis: wider bundles meet most of a scene.
  #define BUNDLE_COSINE 0.9f
  // Relative margin of coordinates: 512 times the rounding error of the triangle test.
  #define BUNDLE_MARGIN 6.1035156e-5f

/// In the frame (s, t, d) about o all rays are at z in [-back, front], with |x| <= wide_x + slope_x z and |y|
/// <= wide_y + slope_y z.
typedef struct {
  vec3 o, s, t, d;
  float wide_x, wide_y, slope_x, slope_y, back, front;
} RayBundle;

FN vec3 to_bundle_frame(const PRIVATE RayBundle* b, vec3 v) {
  return make_vec3(dot3(b->s, v), dot3(b->t, v), dot3(b->d, v));
}

FN vec3 lane_origin(const PRIVATE RayLanes* rays, int j) {
  return make_vec3(rays->ox[j], rays->oy[j], rays->oz[j]);
}
FN vec3 lane_direction(const PRIVATE RayLanes* rays, int j) {
  return make_vec3(rays->dx[j], rays->dy[j], rays->dz[j]);
}

/// The larger of two non-negative floats, by their bits, which are in the same order. NaN is larger than all.
FN int max_bits(int bits, float x) {
  const int other = (int)FLOAT_BITS(x);
  return other > bits ? other : bits;
}

/// A quick test of two rays, which rejects most that are no bundle.
FN bool may_be_bundle(const PRIVATE RayLanes* rays) {
  const vec3 d = lane_direction(rays, 0);
  return (dot3(d, lane_direction(rays, LANES / 2)) > BUNDLE_COSINE) &
         (dot3(d, lane_direction(rays, LANES - 1)) > BUNDLE_COSINE);
}

/// Whether the rays are a bundle; if so, sets `bundle`.
STAGE bool make_bundle(const PRIVATE RayLanes* RESTRICT rays, PRIVATE RayBundle* RESTRICT bundle) {
  int lead = 0, apart = 0, slope_x = 0, slope_y = 0, wide_x = 0, wide_y = 0, back = 0, front = 0;
  while (lead < LANES - 1 && !(rays->tmax[lead] > 0.0f)) lead++;
  RayBundle b;
  b.o = lane_origin(rays, lead);
  b.d = lane_direction(rays, lead);
  b.s = from_frame(b.d, 1.0f, 0.0f, 0.0f);
  b.t = from_frame(b.d, 0.0f, 1.0f, 0.0f);
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 along = to_bundle_frame(&b, lane_direction(rays, j));
      const bool there = rays->tmax[j] > 0.0f;
      apart |= (there & !(along.z > BUNDLE_COSINE)) ? 1 : 0;
      slope_x = max_bits(slope_x, there ? FABS(along.x) / along.z : 0.0f);
      slope_y = max_bits(slope_y, there ? FABS(along.y) / along.z : 0.0f);
    }
  if (apart != 0) return false;
  const float sx = BITS_FLOAT((uint)slope_x), sy = BITS_FLOAT((uint)slope_y);
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 from = to_bundle_frame(&b, sub(lane_origin(rays, j), b.o));
      const bool there = rays->tmax[j] > 0.0f;
      wide_x = max_bits(wide_x, there ? FABS(from.x) - sx * from.z : 0.0f);
      wide_y = max_bits(wide_y, there ? FABS(from.y) - sy * from.z : 0.0f);
      back = max_bits(back, there ? -from.z : 0.0f);
      front = max_bits(front, there ? from.z + dot3(b.d, lane_direction(rays, j)) * rays->tmax[j] : 0.0f);
    }
  b.slope_x = sx;
  b.slope_y = sy;
  b.wide_x = BITS_FLOAT((uint)wide_x);
  b.wide_y = BITS_FLOAT((uint)wide_y);
  b.back = BITS_FLOAT((uint)back);
  b.front = BITS_FLOAT((uint)front);
  *bundle = b;
  return true;
}

/// For each of LANES vertices from `first` on: a bit for each plane around the bundle beyond which the vertex
/// lies.
STAGE void find_sides(const PRIVATE Scene* scene, const PRIVATE RayBundle* RESTRICT bundle, int first,
                      PRIVATE int* RESTRICT sides) {
  const RayBundle b = *bundle;
  const vec3 from_axes = abs3(b.o);
  const float far = from_axes.x + from_axes.y + from_axes.z + b.wide_x + b.wide_y + b.back;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 r = sub(load3(scene->vertices + first + j), b.o), size = abs3(r), p = to_bundle_frame(&b, r);
      const float margin = BUNDLE_MARGIN * (size.x + size.y + size.z + far);
      const float x = b.wide_x + b.slope_x * p.z + margin, y = b.wide_y + b.slope_y * p.z + margin;
      int beyond = p.x > x ? 1 : 0;
      beyond |= p.x < -x ? 2 : 0;
      beyond |= p.y > y ? 4 : 0;
      beyond |= p.y < -y ? 8 : 0;
      beyond |= p.z < -b.back - margin ? 16 : 0;
      beyond |= p.z > b.front + margin ? 32 : 0;
      sides[first + j] = beyond;
    }
}

/// Lists the triangles that the rays may meet, and returns their number. Negative: test all, because the rays
/// are no bundle or may meet more than half.
STAGE int cull_in_bundle(const PRIVATE Scene* scene, const PRIVATE RayLanes* rays, PRIVATE int* listed) {
  RayBundle bundle;
  int sides[MAX_WHOLE_VERTICES];
  const int vertices = scene->header.tables.vertices.count, triangles = scene->header.tables.corners.count;
  if (!make_bundle(rays, &bundle)) return -1;
  for (int first = 0; first < vertices; first += LANES)
    find_sides(scene, &bundle, min_i(first, vertices - LANES), sides);
  int count = 0;
  for (int k = 0; k < triangles; k++) {
    const Corner corner = scene->corners[k];
    listed[count] = k;
    count += (sides[corner.v0] & sides[corner.v1] & sides[corner.v2]) == 0 ? 1 : 0;
  }
  return 2 * count <= triangles ? count : -1;
}

FN int cull_triangles(const PRIVATE Scene* scene, const PRIVATE RayLanes* rays, PRIVATE int* listed) {
  const bool large = scene->header.tables.vertices.count >= LANES;
  return large && may_be_bundle(rays) ? cull_in_bundle(scene, rays, listed) : -1;
}
#endif

PENUMBRA_NAMESPACE_END
#endif
