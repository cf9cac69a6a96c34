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
