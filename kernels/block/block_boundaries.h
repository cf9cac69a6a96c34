// Boundaries of media along rays: which media are behind the boundaries that rays cross, and which boundaries
// contradict each other.
#ifndef PENUMBRA_BLOCK_BOUNDARIES_H
#define PENUMBRA_BLOCK_BOUNDARIES_H
#include "kernels/block/block_boundary_offsets.h"

PENUMBRA_NAMESPACE_BEGIN

/// Encodes the crossing of a boundary (an index, or -1) in a direction as a positive number. The path field
/// `crossed` holds its negative while the crossing contradicts those before it.
FN int crossing_code(int boundary, bool inwards) { return 2 * boundary + (inwards ? 4 : 3); }
FN int boundary_of_code(int code) { return ((code < 0 ? -code : code) - 3) >> 1; }

// How a ray meets a surface:
//   IN_PLACE   at the position of the last boundary
//   CROSSING   it passes a boundary that it has not crossed already
//   ARRIVING   it ends here
//   RIGHT      the crossing is consistent with those before
//   UNENTERED  it leaves a medium that it never entered
//   WITHIN     it passes a surface inside a medium that is no boundary
#define MEETS_IN_PLACE 1
#define MEETS_CROSSING 2
#define MEETS_ARRIVING 4
#define MEETS_RIGHT 8
#define MEETS_UNENTERED 16
#define MEETS_WITHIN 32
#define MEETING_FIELDS(F, a)                                                       \
  F(a, int, ways)       /* MEETS_* */                                              \
  F(a, int, code)       /* see crossing_code */                                    \
  F(a, int, behind_low) /* the media behind the surface, in the ray's direction */ \
  F(a, int, behind_high)
LANE_RECORD(Meeting, Meetings, meeting, MEETING_FIELDS)

FN MediumStack media_of_rays(const PRIVATE PathState* paths, int i, bool shadow) {
  return select_media(shadow, get_shadow_media(paths, i), get_media(paths, i));
}

/// How rays under way meet these surfaces.
///
/// Coincident boundaries must both be crossed. So a ray that crossed a triangle restarts slightly in front of
/// it; the negative sign of the surface's error tells restart_behind. A ray that then meets the same boundary
/// again, at an edge, has crossed it already. At a silhouette the back may be met before the front; then the
/// two crossings cancel.
STAGE void meet_boundaries(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                           const PRIVATE float* RESTRICT lengths, const PRIVATE int* RESTRICT passes,
                           bool shadow, const PRIVATE Surfaces* RESTRICT surfaces,
                           PRIVATE Meetings* RESTRICT meetings) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const bool meets = (get_ray_tmax(&fields, i + j) > 0.0f) & (s.primitive >= 0);
      const bool passing = meets & (passes[j] != 0);
      const int boundary = boundary_of(scene, s.primitive), crossed = get_crossed(&fields, i + j);
      const int code = crossing_code(boundary, s.front);
      const float cosine = dot3(s.geometric, s.wo);
      const bool near = lengths[j] * cosine <= 8.0f * s.error, same_place = (crossed != 0) & near;
      const bool again = same_place & ((crossed == code) | (crossed == -code));
      const bool undone = same_place & (crossed == -crossing_code(boundary, !s.front));
      const bool crosses = passing & (boundary >= 0) & !again, arrives = meets & !passing & !shadow;
      const MediumStack media = media_of_rays(&fields, i + j, shadow), beyond = get_beyond(&fields, i + j);
      const Crossing crossing = cross_boundary(scene, boundary, s.front, media);
      const MediumStack undoing = select_media(shadow, media, beyond);
      const MediumStack behind =
          select_media(undone, undoing, select_media(boundary >= 0, crossing.media, media));
      const bool right = crossing.consistent | undone | (near & crossing.overlaps);
      const bool unentered = arrives & (boundary >= 0) & crossing.unentered & !near;
      // Such a surface ends a part of the flight, which is weighted up to there.
      const bool within_medium = passing & (boundary < 0) & (innermost(media) != 0);
      Meeting m;
      m.ways = ((meets & same_place) ? MEETS_IN_PLACE : 0) | (crosses ? MEETS_CROSSING : 0) |
               (arrives ? MEETS_ARRIVING : 0) | (right ? MEETS_RIGHT : 0) |
               (unentered ? MEETS_UNENTERED : 0) | (within_medium ? MEETS_WITHIN : 0);
      m.code = code;
      m.behind_low = (int)behind.low;
      m.behind_high = (int)behind.high;
      store_meeting(meetings, j, m);
    }
}

// For a path that arrived where a boundary touches another surface. Rounding decides on which side the path
// is, so its later crossings prove nothing.
#define CONTRADICTION_UNKNOWN -1

/// Records crossings, and the first crossing of a path that contradicts those before it, unless another
/// crossing at the same position resolves it: where two media touch, the one that is left may be met last.
STAGE void note_crossings(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          const PRIVATE Meetings* RESTRICT meetings) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Meeting m = load_meeting(meetings, j);
      const int crossed = get_crossed(&fields, i + j), known = get_contradiction(&fields, i + j);
      const bool in_place = (m.ways & MEETS_IN_PLACE) != 0, crosses = (m.ways & MEETS_CROSSING) != 0;
      const bool right = (m.ways & MEETS_RIGHT) != 0, doubtful = crossed < 0;
      const bool was_wrong = doubtful & ((crosses & !right) | !in_place);
      const int unentered = (m.ways & MEETS_UNENTERED) != 0 ? boundary_of_code(m.code) : -1;
      const int wrong = was_wrong ? boundary_of_code(crossed) : unentered;
      const int shape = scene->boundaries[wrong >= 0 ? wrong : 0].shape;
      const bool arrives = (m.ways & MEETS_ARRIVING) != 0;
      const int found = wrong >= 0 ? 1 + shape : ((arrives & in_place) ? CONTRADICTION_UNKNOWN : 0);
      set_contradiction(&fields, i + j, known != 0 ? known : found);
      const bool settled = doubtful & (was_wrong | arrives);
      // Positions are compared with that of the last surface.
      const bool leaves_place = ((m.ways & MEETS_WITHIN) != 0) & !in_place;
      const int kept = leaves_place ? 0 : (settled ? -crossed : crossed);
      set_crossed(&fields, i + j, crosses ? (right ? m.code : -m.code) : kept);
    }
}

/// Updates the media behind boundaries that rays cross (of paths, or of their shadow rays), and the media on
/// both sides of surfaces where paths arrive. If a boundary coincides with such a surface, the path's side is
/// the side before the boundary.
STAGE void cross_boundaries(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, bool shadow,
                            const PRIVATE Meetings* RESTRICT meetings, PRIVATE Surfaces* RESTRICT surfaces) {
  const PathState fields = *paths;
  const int triangles = scene->header.tables.triangles.count;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const Meeting m = load_meeting(meetings, j);
      const bool same_place = (m.ways & MEETS_IN_PLACE) != 0, crosses = (m.ways & MEETS_CROSSING) != 0,
                 arrives = (m.ways & MEETS_ARRIVING) != 0;
      const MediumStack path_media = get_media(&fields, i + j),
                        shadow_media = get_shadow_media(&fields, i + j);
      const MediumStack media = select_media(shadow, shadow_media, path_media);
      const MediumStack beyond = get_beyond(&fields, i + j);
      MediumStack behind;
      behind.low = (uint)m.behind_low;
      behind.high = (uint)m.behind_high;
      // A ray that arrives at the position of a crossed boundary is on the side before it, which is `beyond`.
      const MediumStack side = select_media(same_place, beyond, media);
      const MediumStack next = select_media(crosses, behind, select_media(arrives, side, media));
      set_media(&fields, i + j, select_media(shadow, path_media, next));
      set_shadow_media(&fields, i + j, select_media(shadow, next, shadow_media));
      const MediumStack other =
          select_media(arrives, behind, select_media(crosses & !same_place, media, beyond));
      set_beyond(&fields, i + j, select_media(shadow, beyond, other));
      const float way = get_way(&fields, i + j);
      const bool passes = crosses | ((m.ways & MEETS_WITHIN) != 0);
      const vec3 start = select3(shadow, get_shadow_origin(&fields, i + j), get_kept_origin(&fields, i + j));
      set_way(&fields, i + j, passes ? max_f(distance_to_surface(s, start), 1e-30f) : way);
      const bool along = passes & !shadow;
      NearBoundary met;
      met.normal = select3(along, negate(s.geometric), s.geometric);
      met.depth = 0.0f;
      met.offset = arrives ? s.error : 0.0f;
      met.clearance = safe_distance(s);
      set_boundary(&fields, i + j, select_boundary(along | arrives, met, get_boundary(&fields, i + j)));
      // After the first of two coincident boundaries the ray restarts in front, after the second behind it;
      // otherwise it would meet the first again.
      const bool looks_back = crosses & !same_place & (s.primitive < triangles);
      surfaces->error[j] = looks_back ? -s.error : s.error;
    }
}

/// All three stages, for LANES rays.
FN void follow_boundaries(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          const PRIVATE float* lengths, const PRIVATE int* passes, bool shadow,
                          PRIVATE Surfaces* surfaces) {
  Meetings meetings;
  meet_boundaries(scene, paths, i, lengths, passes, shadow, surfaces, &meetings);
  note_crossings(scene, paths, i, &meetings);
  cross_boundaries(scene, paths, i, shadow, &meetings, surfaces);
}

PENUMBRA_NAMESPACE_END
#endif
