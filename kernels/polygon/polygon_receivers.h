// LANES shading points for which a polygon light's closed forms are computed.
#ifndef PENUMBRA_POLYGON_RECEIVERS_H
#define PENUMBRA_POLYGON_RECEIVERS_H
#include "kernels/features.h"
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  double px[LANES], py[LANES], pz[LANES];  ///< position, relative to the scene's centre
  double nx[LANES], ny[LANES], nz[LANES];  ///< unit shading normal on the side of wo
  double wx[LANES], wy[LANES], wz[LANES];  ///< unit mirror direction of wo about the normal, at most rounding
                                           ///< below the horizon
  double exponent[LANES];                  ///< of the Phong lobe, any real number from 0; negative: no lobe
  // Instead of the Phong lobe, in scenes that need it, a linearly transformed cosine: the unit x axis of its
  // frame, the inverse widths of its matrix (see Ltc), 0 for no lobe, and the shift.
  double tx[LANES], ty[LANES], tz[LANES];
  double inverse_x[LANES], inverse_y[LANES], shift[LANES];
} Receivers;

PENUMBRA_NAMESPACE_END
#endif
