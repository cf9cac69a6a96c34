// LANES shading points that ask for a polygon light's closed forms.
#ifndef PENUMBRA_POLYGON_RECEIVERS_H
#define PENUMBRA_POLYGON_RECEIVERS_H
#include "kernels/features.h"
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  double px[LANES], py[LANES], pz[LANES];  ///< position, relative to the scene's centre
  double nx[LANES], ny[LANES], nz[LANES];  ///< unit shading normal on the viewer's side
  double wx[LANES], wy[LANES], wz[LANES];  ///< unit mirror direction of wo about the normal, at most rounding
                                           ///< below the horizon
  double exponent[LANES];  ///< of the Phong lobe, any real number from 0; negative: no lobe is wanted
  // Instead of it, in scenes that need them, a linearly transformed cosine: of its frame the unit x axis, and
  // of its matrix (see Ltc) the inverse widths, 0 where none is wanted, and the shift.
  double tx[LANES], ty[LANES], tz[LANES];
  double inverse_x[LANES], inverse_y[LANES], shift[LANES];
} Receivers;

PENUMBRA_NAMESPACE_END
#endif
