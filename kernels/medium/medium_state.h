// The fields of paths that concern media.
#ifndef PENUMBRA_MEDIUM_STATE_H
#define PENUMBRA_MEDIUM_STATE_H
#include "kernels/medium/flight.h"
#include "kernels/medium/medium_stack.h"

PENUMBRA_NAMESPACE_BEGIN

// get_media(paths, i), set_media(paths, i, media): stored in two fields of path i.
#define MEDIA_ACCESSORS(name, part)                                              \
  FN MediumStack get_##name(const PRIVATE PathState* paths, int i) {             \
    MediumStack media;                                                           \
    media.low = (uint)get_##part##_low(paths, i);                                \
    media.high = (uint)get_##part##_high(paths, i);                              \
    return media;                                                                \
  }                                                                              \
  FN void set_##name(const PRIVATE PathState* paths, int i, MediumStack media) { \
    set_##part##_low(paths, i, (int)media.low);                                  \
    set_##part##_high(paths, i, (int)media.high);                                \
  }
MEDIA_ACCESSORS(media, media)
MEDIA_ACCESSORS(beyond, beyond)
MEDIA_ACCESSORS(shadow_media, shadow)
#undef MEDIA_ACCESSORS

/// A surface near a path in a medium, see block_boundary_offsets.h.
typedef struct {
  vec3 normal;      // unit, towards the path; 0: no surface is known
  float depth;      // the path's distance from it; 0: on it
  float offset;     // boundary offset: how much farther away the ray's origin is
  float clearance;  // the distance that ray origins should keep from it
} NearBoundary;

FN NearBoundary no_boundary(void) {
  NearBoundary near;
  near.normal = make_vec3(0.0f, 0.0f, 0.0f);
  near.depth = near.offset = near.clearance = 0.0f;
  return near;
}
FN NearBoundary select_boundary(bool condition, NearBoundary a, NearBoundary b) {
  NearBoundary near;
  near.normal = select3(condition, a.normal, b.normal);
  near.depth = condition ? a.depth : b.depth;
  near.offset = condition ? a.offset : b.offset;
  near.clearance = condition ? a.clearance : b.clearance;
  return near;
}
FN NearBoundary get_boundary(const PRIVATE PathState* paths, int i) {
  NearBoundary near;
  near.normal = get_boundary_normal(paths, i);
  near.depth = get_boundary_depth(paths, i);
  near.offset = get_boundary_offset(paths, i);
  near.clearance = get_boundary_clearance(paths, i);
  return near;
}
FN void set_boundary(const PRIVATE PathState* paths, int i, NearBoundary near) {
  set_boundary_normal(paths, i, near.normal);
  set_boundary_depth(paths, i, near.depth);
  set_boundary_offset(paths, i, near.offset);
  set_boundary_clearance(paths, i, near.clearance);
}

FN FlightWeight flight_weight(const PRIVATE PathState* paths, int i) {
  FlightWeight w;
  w.throughput = get_throughput(paths, i);
  w.channels = get_channels(paths, i);
  w.density = get_direction_pdf(paths, i);
  return w;
}
FN void set_flight_weight(const PRIVATE PathState* paths, int i, FlightWeight w) {
  set_throughput(paths, i, w.throughput);
  set_channels(paths, i, w.channels);
  set_direction_pdf(paths, i, w.density);
}

PENUMBRA_NAMESPACE_END
#endif
