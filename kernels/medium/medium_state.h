// What paths keep of media.
#ifndef PENUMBRA_MEDIUM_STATE_H
#define PENUMBRA_MEDIUM_STATE_H
#include "kernels/medium/flight.h"
#include "kernels/medium/medium_stack.h"

PENUMBRA_NAMESPACE_BEGIN

#if HAS(MEDIA)
  // get_media(paths, i), set_media(paths, i, media): from, and into, two numbers of path i.
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

/// The surface near a path, in media.
typedef struct {
  vec3 normal;      // unit, towards the path's side of it; 0: none is known
  float depth;      // how far the path is off it, 0: on it
  float lift;       // how much farther the ray's origin is
  float clearance;  // how far off it origins of rays are to be
} Wall;

FN Wall no_wall(void) {
  Wall wall;
  wall.normal = make_vec3(0.0f, 0.0f, 0.0f);
  wall.depth = wall.lift = wall.clearance = 0.0f;
  return wall;
}
FN Wall select_wall(bool condition, Wall a, Wall b) {
  Wall wall;
  wall.normal = select3(condition, a.normal, b.normal);
  wall.depth = condition ? a.depth : b.depth;
  wall.lift = condition ? a.lift : b.lift;
  wall.clearance = condition ? a.clearance : b.clearance;
  return wall;
}
FN Wall get_wall(const PRIVATE PathState* paths, int i) {
  Wall wall;
  wall.normal = get_wall_normal(paths, i);
  wall.depth = get_wall_depth(paths, i);
  wall.lift = get_wall_lift(paths, i);
  wall.clearance = get_wall_clearance(paths, i);
  return wall;
}
FN void set_wall(const PRIVATE PathState* paths, int i, Wall wall) {
  set_wall_normal(paths, i, wall.normal);
  set_wall_depth(paths, i, wall.depth);
  set_wall_lift(paths, i, wall.lift);
  set_wall_clearance(paths, i, wall.clearance);
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
#endif

PENUMBRA_NAMESPACE_END
#endif
