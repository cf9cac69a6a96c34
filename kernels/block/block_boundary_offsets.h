// The boundary offset: the distance of a path to the boundary of its medium, more exact than its position. In
// a dense medium, paths scatter closer to the boundary than a ray can start without missing it. So rays start
// farther away, and the path stores its own distance to the boundary.
#ifndef PENUMBRA_BLOCK_BOUNDARY_OFFSETS_H
#define PENUMBRA_BLOCK_BOUNDARY_OFFSETS_H
#include "kernels/block/path_state.h"
#include "kernels/intersect/surface.h"
#include "kernels/medium/medium_state.h"

PENUMBRA_NAMESPACE_BEGIN

/// The distance from a surface, along its normal, at which a point is surely in front of it. Distances along
/// rays that pass beside the surface are sums of terms as large as its extent.
FN float safe_distance(Surface s) { return max_f(4.0f * s.error, POSITION_ERROR * s.span); }

/// Distance along the ray from `start` to the surface. It uses the surface's plane, from which s.p deviates
/// by s.error only.
FN float distance_to_surface(Surface s, vec3 start) {
  const vec3 back = sub(start, s.p);
  const float cosine = dot3(s.geometric, s.wo);
  return cosine > 1e-3f ? dot3(s.geometric, back) / cosine : dot3(back, s.wo);
}

/// Length of the flight that ends at the surface: from the last surface that the ray passed, or from the
/// path's position. If the path is near this surface, its boundary offset is more exact than the ray.
FN float flight_to(const PRIVATE PathState* paths, int i, MediumStack media, Surface s, vec3 start) {
  const NearBoundary near = get_boundary(paths, i);
  const float way = get_way(paths, i), to = distance_to_surface(s, start) - way;
  const bool first = (way == 0.0f) & (innermost(media) != 0), on_it = near.depth == 0.0f;
  const float alike = dot3(s.geometric, near.normal), cosine = max_f(dot3(s.geometric, s.wo), 1e-4f);
  const bool turned = on_it & (dot3(near.normal, s.wo) > 0.0f);
  const float shorter = (turned ? -near.offset : near.offset) * alike / cosine;
  const float origin_depth = near.depth + near.offset;
  const bool known = !on_it & (alike > 0.9999997f) & (origin_depth < 256.0f * s.error) &
                     (FABS(to * cosine - origin_depth) <= s.error);
  return max_f(first ? (known ? near.depth / cosine : to - shorter) : to, 0.0f);
}

/// Moves paths to where they scatter: at `reaches` along their flights; negative: no scattering.
///
/// Ray origins are kept clear of the surfaces behind and ahead, so that the next ray meets them. Between two
/// close surfaces the origin is in the middle.
STAGE void scatter_in_media(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces,
                            const PRIVATE float* RESTRICT lengths, const PRIVATE float* RESTRICT reaches) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const bool meets = s.primitive >= 0, scatters = reaches[j] >= 0.0f;
      const vec3 start = get_kept_origin(&fields, i + j), d = get_ray_direction(&fields, i + j);
      const NearBoundary near = get_boundary(&fields, i + j);
      const float way = get_way(&fields, i + j);
      const float reach = reaches[j], cosine = max_f(dot3(s.geometric, s.wo), 0.0f);
      const float slope = dot3(near.normal, d);
      const bool turned = (near.depth == 0.0f) & (slope < 0.0f),
                 near_boundary = dot3(near.normal, near.normal) > 0.5f;
      const vec3 inwards = select3(turned, negate(near.normal), near.normal);
      const float descent = reach * (turned ? -slope : slope), below = near.depth + descent;
      const bool leaves = near_boundary & (descent >= 0.0f);
      // Distances along the ray, without the boundary offset.
      const float to = distance_to_surface(s, start) - way;
      const float ahead = meets ? (to - reach) * cosine : NO_LIMIT,
                  behind = leaves ? below + near.offset : NO_LIMIT;
      const float middle = 0.5f * ahead + 0.5f * behind, room = leaves ? middle : to * cosine;
      const float rise = max_f(min_f(safe_distance(s), room) - ahead, 0.0f),
                  sink = max_f(min_f(near.clearance, middle) - behind, 0.0f);
      const vec3 flown = scale(d, way + reach);
      const vec3 lifted = add_scaled(scale(s.geometric, meets ? rise : 0.0f), leaves ? sink : 0.0f, inwards);
      const vec3 p = add(start, add(flown, lifted));
      const vec3 off = sub(sub(p, start), flown);  // by the shift and by rounding
      // Keeps the nearer of both boundaries, preferring the one that the ray met.
      const float above = (lengths[j] - reach) * cosine;
      const bool stays = near_boundary & (below > 0.0f), changes = meets & !(stays & (above >= 2.0f * below));
      NearBoundary next;
      next.normal = select3(changes, s.geometric, select3(stays, inwards, no_boundary().normal));
      next.depth = max_f(changes ? above : below, 1e-30f);
      next.offset = (changes ? ahead - above : near.offset) + dot3(next.normal, off);
      next.clearance = changes ? safe_distance(s) : near.clearance;
      set_ray_origin(&fields, i + j, select3(scatters, p, get_ray_origin(&fields, i + j)));
      set_boundary(&fields, i + j, select_boundary(scatters, next, near));
    }
}

PENUMBRA_NAMESPACE_END
#endif
