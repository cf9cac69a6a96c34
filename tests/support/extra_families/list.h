// Additional BSDF families that only tests have, for kernels/bsdf/families.h. They cover properties that none
// of the renderer's own families has.
#ifndef PENUMBRA_EXTRA_FAMILY_LIST_H
#define PENUMBRA_EXTRA_FAMILY_LIST_H
#include "tests/support/extra_families/numbers.h"

// Six of the same cost, for families_benchmark.
#define SIX_PHONGS(X)                                     \
  X(phong_a, PHONG_A, FAMILY_PHONG_A, SEVERAL_LOBES, "1") \
  X(phong_b, PHONG_B, FAMILY_PHONG_B, SEVERAL_LOBES, "2") \
  X(phong_c, PHONG_C, FAMILY_PHONG_C, SEVERAL_LOBES, "3") \
  X(phong_d, PHONG_D, FAMILY_PHONG_D, SEVERAL_LOBES, "4") \
  X(phong_e, PHONG_E, FAMILY_PHONG_E, SEVERAL_LOBES, "5") \
  X(phong_f, PHONG_F, FAMILY_PHONG_F, SEVERAL_LOBES, "6")

#define EXTRA_BSDF_FAMILIES(X)                                                             \
  X(mirror, MIRROR, FAMILY_MIRROR, DELTA, "mirror")                                        \
  X(window, WINDOW, FAMILY_WINDOW, TRANSMITS | DELTA, "pane that bends nothing")           \
  X(refracting, REFRACTING, FAMILY_REFRACTING, TRANSMITS | DELTA, "glass without Fresnel") \
  X(glossy, GLOSSY, FAMILY_GLOSSY, SEVERAL_LOBES, "Phong BSDF without closed form")        \
  X(crude, CRUDE, FAMILY_CRUDE, SEVERAL_LOBES, "Phong BSDF with crude control lobes")      \
  SIX_PHONGS(X)
#define EXTRA_LTC_FAMILIES(X) X(crude, CRUDE)

#endif
