// Finds the surfaces that the rays of LANES paths hit: one lane loop for each part of the work that the scene
// needs.
#ifndef PENUMBRA_BLOCK_SURFACE_H
#define PENUMBRA_BLOCK_SURFACE_H
#include "kernels/block/block_instances.h"
#include "kernels/block/path_state.h"
#include "kernels/bsdf/bend_normal.h"
#include "kernels/intersect/surface.h"
#include "kernels/medium/medium_state.h"
#include "kernels/motion/moving_surface.h"

PENUMBRA_NAMESPACE_BEGIN

/// The triangle that LANES rays hit, if they all hit the same one or nothing, as many camera rays do. Its
/// vertices are then read once, not by every lane. -1: they hit several primitives.
FN int only_triangle(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  int last = -1, others = 0;
  for (int j = i; j < i + LANES; j++) last = max_i(last, get_hit(paths, j));
  for (int j = i; j < i + LANES; j++)
    others |= ((get_hit(paths, j) >= 0) & (get_hit(paths, j) != last)) ? 1 : 0;
  const bool only = (others == 0) & (last < scene->header.tables.triangles.count);
  return only ? last : -1;
}

/// The triangle of a lane: `only`, or its own triangle if `only` is negative.
FN int hit_triangle(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int only) {
  return only >= 0 ? only : triangle_of(scene, get_hit(paths, i));
}

FN void find_points_on(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int only,
                       PRIVATE PrimitivePoints* RESTRICT points) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      store_primitive_point(points, j,
                            triangle_point(scene, hit_triangle(scene, paths, i + j, only),
                                           get_ray_origin(paths, i + j), get_ray_direction(paths, i + j)));
}
STAGE void find_triangle_points(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int only,
                                PRIVATE PrimitivePoints* RESTRICT points) {
  if (only >= 0)
    find_points_on(scene, paths, i, only, points);
  else
    find_points_on(scene, paths, i, -1, points);
}

FN void interpolate_normals_on(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int only,
                               PRIVATE PrimitivePoints* RESTRICT points) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int triangle = hit_triangle(scene, paths, i + j, only);
      const vec3 normal = interpolated_normal(scene, triangle, load_primitive_point(points, j));
      STORE_LANE_vec3(points->shading, j, normal);
    }
}
STAGE void interpolate_normals(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int only,
                               PRIVATE PrimitivePoints* RESTRICT points) {
  if (only >= 0)
    interpolate_normals_on(scene, paths, i, only, points);
  else
    interpolate_normals_on(scene, paths, i, -1, points);
}

// Replaces the points of lanes whose primitive is a quadric for which `such` holds by `point_of`.
#define FIND_POINTS_OF_QUADRICS(stage, point_of, such)                                                    \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,                     \
                   PRIVATE PrimitivePoints* RESTRICT points) {                                            \
    const int triangle_count = scene->header.tables.triangles.count;                                      \
    LANE_LOOP                                                                                             \
      for (int j = 0; j < LANES; j++) {                                                                   \
        const int quadric = get_hit(paths, i + j) - triangle_count;                                       \
        const PrimitivePoint other = load_primitive_point(points, j);                                     \
        const PrimitivePoint r = point_of(load_quadric(scene->quadrics + (quadric >= 0 ? quadric : 0)),   \
                                          get_ray_origin(paths, i + j), get_ray_direction(paths, i + j)); \
        store_primitive_point(points, j, select_primitive_point(such(scene, quadric), r, other));         \
      }                                                                                                   \
  }
FIND_POINTS_OF_QUADRICS(find_quadric_points, point_on_sphere_or_disk, is_quadric)
FIND_POINTS_OF_QUADRICS(find_cylinder_points, point_on_cylinder, is_cylinder)
#undef FIND_POINTS_OF_QUADRICS

FN bool any_quadric_hit(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  int last = -1;
  for (int j = i; j < i + LANES; j++) last = max_i(last, get_hit(paths, j));
  return last >= scene->header.tables.triangles.count;
}

/// The instance whose primitive a lane's ray hit, or -1.
FN int instance_hit(const PRIVATE PathState* paths, int i) {
  const int hit = get_hit(paths, i), instance = get_hit_instance(paths, i);
  return hit >= 0 ? instance : -1;
}

FN bool any_instance_hit(const PRIVATE PathState* paths, int i) {
  int any = 0;
  for (int j = i; j < i + LANES; j++) any |= instance_hit(paths, j) >= 0 ? 1 : 0;
  return any != 0;
}

/// Replaces the points of lanes whose rays hit instances. They were first computed as if the primitive were
/// not instanced.
STAGE void find_instance_points(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                PRIVATE PrimitivePoints* RESTRICT points) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int instance = instance_hit(paths, i + j);
      const PrimitivePoint other = load_primitive_point(points, j);
      const Instance at = load_instance(scene->instances + (instance >= 0 ? instance : 0));
      const PrimitivePoint r = instance_point(scene, get_hit(paths, i + j), at, get_ray_origin(paths, i + j),
                                              get_ray_direction(paths, i + j));
      store_primitive_point(points, j, select_primitive_point(instance >= 0, r, other));
    }
}

STAGE void note_instances(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) surfaces->instance[j] = instance_hit(paths, i + j);
}

STAGE void note_spans(const PRIVATE PrimitivePoints* RESTRICT points, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) surfaces->span[j] = max_component(load_primitive_point(points, j).extent);
}

STAGE void see_surfaces(const PRIVATE PathState* paths, int i, const PRIVATE PrimitivePoints* RESTRICT points,
                        PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      store_surface_hit(surfaces, j,
                        seen_surface(get_hit(paths, i + j), get_ray_origin(paths, i + j),
                                     get_ray_direction(paths, i + j), load_primitive_point(points, j)));
}

FN void find_uvs_on(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int only,
                    const PRIVATE PrimitivePoints* RESTRICT points, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      store_surface_uv(surfaces, j,
                       with_triangle_uv(scene, hit_triangle(scene, paths, i + j, only),
                                        load_primitive_point(points, j), load_surface(surfaces, j)));
}
STAGE void find_triangle_uvs(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int only,
                             const PRIVATE PrimitivePoints* RESTRICT points,
                             PRIVATE Surfaces* RESTRICT surfaces) {
  if (only >= 0)
    find_uvs_on(scene, paths, i, only, points, surfaces);
  else
    find_uvs_on(scene, paths, i, -1, points, surfaces);
}

STAGE void find_quadric_uvs(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                            const PRIVATE PrimitivePoints* RESTRICT points,
                            PRIVATE Surfaces* RESTRICT surfaces) {
  const int triangle_count = scene->header.tables.triangles.count;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int quadric = get_hit(paths, i + j) - triangle_count;
      const Surface other = load_surface(surfaces, j);
      const Surface s =
          with_quadric_uv(scene, quadric >= 0 ? quadric : 0, load_primitive_point(points, j), other);
      store_surface_uv(surfaces, j, select_surface(quadric >= 0, s, other));
    }
}

/// The surfaces' instances must be set.
STAGE void find_instance_uvs(const PRIVATE Scene* scene, const PRIVATE PrimitivePoints* RESTRICT points,
                             PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface other = load_surface(surfaces, j);
      const Instance at = load_instance(scene->instances + (other.instance >= 0 ? other.instance : 0));
      const Surface s = with_instance_uv(scene, other.primitive, at, load_primitive_point(points, j), other);
      store_surface_uv(surfaces, j, select_surface(other.instance >= 0, s, other));
    }
}

/// Whether any of LANES paths hit what moves: a primitive, or an instance.
FN bool any_moving_hit(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, bool instances) {
  int any = 0;
  for (int j = i; j < i + LANES; j++) {
    const int hit = get_hit(paths, j), instance = NEEDS(scene, INSTANCES) ? instance_hit(paths, j) : -1;
    const bool moves = instances ? is_moving_instance(scene, instance)
                                 : (is_moving_triangle(scene, hit, instance) |
                                    (NEEDS(scene, QUADRICS) && is_moving_quadric(scene, hit, instance)));
    any |= moves ? 1 : 0;
  }
  return any != 0;
}

/// Replaces the points of lanes whose rays hit what moves. They were first computed as if it were still.
STAGE void find_moving_triangle_points(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                       bool instances, PRIVATE PrimitivePoints* RESTRICT points) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int hit = get_hit(paths, i + j), instance = instances ? instance_hit(paths, i + j) : -1;
      const bool moves = is_moving_triangle(scene, hit, instance);
      const PrimitivePoint other = load_primitive_point(points, j);
      const TriangleState s = triangle_state(scene, hit, moves, get_time(paths, i + j));
      const PrimitivePoint r = moving_triangle_point(scene, moves ? hit : 0, s, get_ray_origin(paths, i + j),
                                                     get_ray_direction(paths, i + j));
      store_primitive_point(points, j, select_primitive_point(moves, r, other));
    }
}
STAGE void find_moving_quadric_points(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                      bool instances, PRIVATE PrimitivePoints* RESTRICT points) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int hit = get_hit(paths, i + j), instance = instances ? instance_hit(paths, i + j) : -1;
      const bool moves = is_moving_quadric(scene, hit, instance);
      const PrimitivePoint other = load_primitive_point(points, j);
      const Quadric q = quadric_state(scene, hit, moves, get_time(paths, i + j));
      const PrimitivePoint r =
          point_on_quadric(q, get_ray_origin(paths, i + j), get_ray_direction(paths, i + j));
      store_primitive_point(points, j, select_primitive_point(moves, r, other));
    }
}
STAGE void find_moving_instance_points(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                       PRIVATE PrimitivePoints* RESTRICT points) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int instance = instance_hit(paths, i + j);
      const bool moves = is_moving_instance(scene, instance);
      const PrimitivePoint other = load_primitive_point(points, j);
      const Instance at = instance_state(scene, instance, moves, get_time(paths, i + j));
      const PrimitivePoint r = instance_point(scene, get_hit(paths, i + j), at, get_ray_origin(paths, i + j),
                                              get_ray_direction(paths, i + j));
      store_primitive_point(points, j, select_primitive_point(moves, r, other));
    }
}
FN void find_moving_points(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                           PRIVATE PrimitivePoints* points) {
  const bool instances = NEEDS(scene, INSTANCES);
  const TableSpans tables = scene->header.tables;
  if (any_moving_hit(scene, paths, i, false)) {
    if (tables.triangle_states.count > 0) find_moving_triangle_points(scene, paths, i, instances, points);
    if (HAS(QUADRICS) && tables.quadric_states.count > 0)
      find_moving_quadric_points(scene, paths, i, instances, points);
  }
  if (HAS(INSTANCES) && instances && any_moving_hit(scene, paths, i, true))
    find_moving_instance_points(scene, paths, i, points);
}

/// Likewise their texture coordinates and tangents. The surfaces' instances and times must be set.
FN void find_moving_uvs(const PRIVATE Scene* scene, const PRIVATE PrimitivePoints* points,
                        PRIVATE Surfaces* surfaces) {
  for (int j = 0; j < LANES; j++) {
    Surface s = load_surface(surfaces, j);
    if (!NEEDS(scene, INSTANCES)) s.instance = -1;
    const PrimitivePoint r = load_primitive_point(points, j);
    if (HAS(INSTANCES) && is_moving_instance(scene, s.instance)) {
      s = with_instance_uv(scene, s.primitive, instance_at(scene, s.instance, s.time), r, s);
    } else if (is_moving_triangle(scene, s.primitive, s.instance)) {
      const TriangleState at = triangle_at(scene, s.primitive, s.time);
      GLOBAL const VertexUvs* corners = uvs_of(scene, s.primitive);
      s = with_uv(s, triangle_uv(corners, r.b0, r.b1, r.b2), r.normal,
                  triangle_du(corners, at.p0, at.p1, at.p2));
    } else if (HAS(QUADRICS) && is_moving_quadric(scene, s.primitive, s.instance)) {
      const int quadric = s.primitive - scene->header.tables.triangles.count;
      const QuadricUv uv = quadric_uv(quadric_at(scene, quadric, s.time), r.p);
      s = with_uv(s, uv.at, r.normal, uv.du);
    } else
      continue;
    store_surface_uv(surfaces, j, s);
  }
}

/// Replaces the tangents of lanes whose rays hit triangles that have tangents of their own. The surfaces'
/// instances and times must be set.
STAGE void find_vertex_tangents(const PRIVATE Scene* scene, const PRIVATE PrimitivePoints* points,
                                PRIVATE Surfaces* surfaces) {
  const bool moves = has_moving_surfaces(scene);
  for (int j = 0; j < LANES; j++) {
    Surface s = load_surface(surfaces, j);
    if (s.primitive < 0 || s.primitive >= scene->header.tables.vertex_tangents.count) continue;
    const bool instanced = NEEDS(scene, INSTANCES) && s.instance >= 0;
    const float time = NEEDS_MOTION(scene) ? s.time : 0.0f;
    const Instance at = instanced ? instance_of(scene, s.instance, time) : load_instance(scene->instances);
    GLOBAL const Triangle* t = scene->triangles + s.primitive;
    vec3 p0 = load3(&t->p0), p1 = load3(&t->p1), p2 = load3(&t->p2);
    if (HAS(MOTION) && moves && is_moving_triangle(scene, s.primitive, instanced ? s.instance : -1)) {
      const TriangleState now = triangle_at(scene, s.primitive, s.time);
      p0 = now.p0;
      p1 = now.p1;
      p2 = now.p2;
    }
    store_surface_uv(surfaces, j,
                     with_vertex_tangents(scene, s.primitive, p0, p1, p2, instanced, at,
                                          load_primitive_point(points, j), s));
  }
}

/// Replaces the points of lanes whose rays hit curves.
STAGE void find_curve_points(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                             PRIVATE PrimitivePoints* points) {
  for (int j = 0; j < LANES; j++) {
    const int curve = curve_of(scene, get_hit(paths, i + j));
    if (curve < 0) continue;
    const vec3 o = get_ray_origin(paths, i + j), d = get_ray_direction(paths, i + j);
    const int instance = NEEDS(scene, INSTANCES) ? instance_hit(paths, i + j) : -1;
    PrimitivePoint r;
    if (HAS(INSTANCES) && instance >= 0) {
      const float time = NEEDS_MOTION(scene) ? get_time(paths, i + j) : 0.0f;
      r = instance_curve_point(scene, curve, instance_of(scene, instance, time), o, d);
    } else
      r = point_on_curve(load_quadric(scene->quadrics + curve), o, d);
    store_primitive_point(points, j, r);
  }
}

/// Likewise their texture coordinates and tangents. The surfaces' instances and times must be set.
STAGE void find_curve_uvs(const PRIVATE Scene* scene, const PRIVATE PrimitivePoints* points,
                          PRIVATE Surfaces* surfaces) {
  for (int j = 0; j < LANES; j++) {
    Surface s = load_surface(surfaces, j);
    const int curve = curve_of(scene, s.primitive);
    if (curve < 0) continue;
    const PrimitivePoint r = load_primitive_point(points, j);
    if (HAS(INSTANCES) && NEEDS(scene, INSTANCES) && s.instance >= 0)
      s = with_instance_curve_uv(scene, curve,
                                 instance_of(scene, s.instance, NEEDS_MOTION(scene) ? s.time : 0.0f), r, s);
    else
      s = with_curve_uv(scene, curve, r, s);
    store_surface_uv(surfaces, j, s);
  }
}

STAGE void note_times(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) surfaces->time[j] = get_time(paths, i + j);
}

/// The surfaces that the last rays of LANES paths from lane i on hit, without chosen leaves, media and bent
/// normals.
JIT_CALLED_FN void find_hit_surfaces(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                     PRIVATE Surfaces* surfaces) {
  PrimitivePoints points;
  const int only = only_triangle(scene, paths, i);
  find_triangle_points(scene, paths, i, only, &points);
  if (NEEDS(scene, SHADING_NORMALS)) interpolate_normals(scene, paths, i, only, &points);
  const bool quadrics = NEEDS(scene, QUADRICS) && any_quadric_hit(scene, paths, i);
  if (HAS(QUADRICS) && quadrics) find_quadric_points(scene, paths, i, &points);
  if (NEEDS(scene, CYLINDERS) && quadrics) find_cylinder_points(scene, paths, i, &points);
  const bool instances = NEEDS(scene, INSTANCES) && any_instance_hit(paths, i);
  if (HAS(INSTANCES) && instances) find_instance_points(scene, paths, i, &points);
  const bool moves = has_moving_surfaces(scene);
  if (HAS(MOTION) && moves) find_moving_points(scene, paths, i, &points);
  const bool curves = NEEDS(scene, CURVES) && quadrics;
  if (HAS(CURVES) && curves) find_curve_points(scene, paths, i, &points);
  see_surfaces(paths, i, &points, surfaces);
  if (NEEDS_MOTION(scene)) note_times(paths, i, surfaces);
  if (NEEDS_MEDIA(scene)) note_spans(&points, surfaces);
  if (NEEDS(scene, INSTANCES)) note_instances(paths, i, surfaces);
  if (NEEDS(scene, UV)) find_triangle_uvs(scene, paths, i, only, &points, surfaces);
  if (NEEDS(scene, UV) && HAS(QUADRICS) && quadrics) find_quadric_uvs(scene, paths, i, &points, surfaces);
  if (NEEDS(scene, UV) && HAS(INSTANCES) && instances) find_instance_uvs(scene, &points, surfaces);
  if (NEEDS(scene, UV) && HAS(MOTION) && moves) find_moving_uvs(scene, &points, surfaces);
  if (NEEDS(scene, UV) && HAS(CURVES) && curves) find_curve_uvs(scene, &points, surfaces);
  if (NEEDS(scene, TANGENTS)) find_vertex_tangents(scene, &points, surfaces);
}

/// Measures distances from where rays started, before any surface that they passed.
STAGE void see_from_starts(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 start = get_kept_origin(paths, i + j), d = get_ray_direction(paths, i + j);
      surfaces->distance[j] += dot3(sub(get_ray_origin(paths, i + j), start), d);
      STORE_LANE_vec3(surfaces->from, j, start);
    }
}

/// Replaces the materials by the chosen leaves.
STAGE void see_leaves(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int leaf = get_material(paths, i + j), own = surfaces->material[j];
      surfaces->material[j] = leaf >= 0 ? leaf : own;
    }
}

/// Replaces the materials where paths meet the surface of the interior that they are in from inside, if that
/// has a material of its own for them: see interiors.h.
STAGE void see_exits(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                     PRIVATE Surfaces* RESTRICT surfaces) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int medium = innermost(get_media(&fields, i + j)), exit = scene->media[medium].exit;
      const int boundary = boundary_of(scene, surfaces->primitive[j]);
      const int interior = scene->boundaries[boundary >= 0 ? boundary : 0].interior;
      const bool leaves =
          (boundary >= 0) & (interior == medium) & (exit >= 0) & !load_surface(surfaces, j).front;
      const int own = surfaces->material[j];
      surfaces->material[j] = leaves ? exit : own;
    }
}

/// Whether all of LANES paths scatter in media, as is common where paths are sorted by family.
FN bool all_in_media(const PRIVATE PathState* paths, int i) {
  int others = 0;
  for (int j = i; j < i + LANES; j++) others |= get_hit(paths, j) != IN_MEDIUM ? 1 : 0;
  return others == 0;
}

/// For such paths, instead of find_hit_surfaces.
STAGE void see_no_surfaces(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      store_surface(surfaces, j, surface_in_medium(get_ray_origin(paths, i + j)));
}

/// Replaces the surfaces of paths that scatter in media.
STAGE void see_media(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface other = load_surface(surfaces, j);
      Surface s = surface_in_medium(get_ray_origin(paths, i + j));
      s.from = other.from;
      s.wo = negate(get_ray_direction(paths, i + j));
      s.distance = dot3(sub(s.p, s.from), get_ray_direction(paths, i + j));
      s.material = other.material;
      store_surface(surfaces, j, select_surface(get_hit(paths, i + j) == IN_MEDIUM, s, other));
    }
}

/// Where the last rays of LANES paths from lane i on ended.
JIT_CALLED_FN void find_surfaces(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                 PRIVATE Surfaces* surfaces) {
  if (NEEDS_MEDIA(scene) && all_in_media(paths, i))
    see_no_surfaces(paths, i, surfaces);
  else
    find_hit_surfaces(scene, paths, i, surfaces);
  if (NEEDS(scene, NESTED)) see_from_starts(paths, i, surfaces);
  if (NEEDS(scene, NESTED)) see_leaves(paths, i, surfaces);
  if (NEEDS_INTERIORS(scene)) see_exits(scene, paths, i, surfaces);
  if (NEEDS_MEDIA(scene)) see_media(paths, i, surfaces);
  if (NEEDS_MEDIA(scene) && NEEDS_MOTION(scene)) note_times(paths, i, surfaces);
  if (NEEDS(scene, BENT)) bend_normals(scene, surfaces);
}

PENUMBRA_NAMESPACE_END
#endif
