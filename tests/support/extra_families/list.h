// Additional BSDF families that only tests have, for kernels/bsdf/families.h. They cover properties that none
// of the renderer's own families has.
#ifndef PENUMBRA_EXTRA_FAMILY_LIST_H
#define PENUMBRA_EXTRA_FAMILY_LIST_H
#include "tests/support/extra_families/numbers.h"

#define EXTRA_BSDF_FAMILIES(X)                                                             \
  X(mirror, MIRROR, FAMILY_MIRROR, DELTA, "mirror")                                        \
  X(window, WINDOW, FAMILY_WINDOW, TRANSMITS | DELTA, "pane that bends nothing")           \
  X(refracting, REFRACTING, FAMILY_REFRACTING, TRANSMITS | DELTA, "glass without Fresnel") \
  X(glossy, GLOSSY, FAMILY_GLOSSY, SEVERAL_LOBES, "Phong BSDF without closed form")        \
  X(crude, CRUDE, FAMILY_CRUDE, SEVERAL_LOBES, "Phong BSDF with crude control lobes")
#define EXTRA_LTC_FAMILIES(X) X(crude, CRUDE)

#endif
