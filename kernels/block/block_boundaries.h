// Boundaries of media on the way of rays: which media are behind those that rays cross, and which contradict
// each other.
#ifndef PENUMBRA_BLOCK_BOUNDARIES_H
#define PENUMBRA_BLOCK_BOUNDARIES_H
#include "kernels/block/block_boundary_offsets.h"

PENUMBRA_NAMESPACE_BEGIN

/// Of a boundary, or -1, that is crossed in that direction: above 0 or, as long as it contradicts those
/// before, its negative.
FN int crossing_code(int boundary, bool inwards) { return 2 * boundary + (inwards ? 4 : 3); }
FN int boundary_of_code(int code) { return ((code < 0 ? -code : code) - 3) >> 1; }

// How a ray meets a surface: in the place of the last boundary; passing a boundary, which it has not
// crossed already; arriving; as those before say; leaving a medium that it never entered; passing within a
// medium what bounds none.
#define MEETS_IN_PLACE 1
#define MEETS_CROSSING 2
#define MEETS_ARRIVING 4
#define MEETS_RIGHT 8
#define MEETS_UNENTERED 16
#define MEETS_WITHIN 32
#define MEETING_FIELDS(F, a)                                       \
  F(a, int, ways)       /* MEETS_* */                              \
  F(a, int, code)       /* see crossing_code */                    \
  F(a, int, behind_low) /* the media behind it, as the ray goes */ \
  F(a, int, behind_high)
LANE_RECORD(Meeting, Meetings, meeting, MEETING_FIELDS)

FN MediumStack media_of_rays(const PRIVATE PathState* paths, int i, bool shadow) {
  return select_media(shadow, get_shadow_media(paths, i), get_media(paths, i));
}

/// How rays under way meet these surfaces.
///
/// Of two boundaries in one place both are crossed: a ray goes on a little before a triangle that it crossed
/// (the error's sign says so to restart_behind), and one that then meets the same boundary again, at an edge
/// of it, has crossed it already. At a silhouette the back may be met before the front: then both are undone.
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
      // Flights are weighed as far as there.
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

// Of a path that was where a boundary meets another surface, so that rounding says on which side it is:
// what it crosses from there on says nothing.
#define CONTRADICTION_UNKNOWN -1

/// Notes the crossings, and the first of a path that contradicts those before it and that nothing in the same
/// place sets right: of two touching media the one that is left may be met last.
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
      // Places are compared to that of the last surface.
      const bool leaves_place = ((m.ways & MEETS_WITHIN) != 0) & !in_place;
      const int kept = leaves_place ? 0 : (settled ? -crossed : crossed);
      set_crossed(&fields, i + j, crosses ? (right ? m.code : -m.code) : kept);
    }
}

/// Which media are behind what rays cross, of paths or of their shadow rays, and on either side of the
/// surfaces where paths arrive. Where a boundary is in the place of such a surface, the side of the path is
/// that before the boundary.
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
      // Before: those of the ray's side, where it arrives those behind the surface.
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
      // The second of two in one place is left behind, or the first would be met again.
      const bool looks_back = crosses & !same_place & (s.primitive < triangles);
      surfaces->error[j] = looks_back ? -s.error : s.error;
    }
}

/// All of it, of LANES rays.
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
