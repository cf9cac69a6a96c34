// Control lobes of LANES closures: a lane loop for each family that has some.
#ifndef PENUMBRA_CONTROL_LANES_H
#define PENUMBRA_CONTROL_LANES_H
#include "kernels/bsdf/bsdf.h"
#include "kernels/bsdf/control_lobes.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

#define CONTROL_FAMILY(name, NAME)                                                                         \
  STAGE void control_##name##_lanes(const PRIVATE Scene* scene, const PRIVATE Closures* RESTRICT closures, \
                                    const PRIVATE Surfaces* RESTRICT surfaces,                             \
                                    PRIVATE ControlLanes* RESTRICT controls) {                             \
    LANE_LOOP                                                                                              \
      for (int j = 0; j < LANES; j++) {                                                                    \
        const Closure c = load_closure(closures, j);                                                       \
        const Surface s = load_surface(surfaces, j);                                                       \
        const ControlLobes own = name##_control(scene, c, max_f(dot3(s.shading, s.wo), 0.0f));             \
        const ControlLobes before = load_control_lobes(controls, j);                                       \
        store_control_lobes(controls, j, select_control_lobes(c.family == FAMILY_##NAME, own, before));    \
      }                                                                                                    \
  }
LTC_FAMILIES(CONTROL_FAMILY)
#undef CONTROL_FAMILY

STAGE void clear_controls(PRIVATE ControlLanes* RESTRICT controls) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_control_lobes(controls, j, no_control_lobes());
}

/// Computes the control lobes of closures of `families`; others have none.
FN void find_controls(const PRIVATE Scene* scene, ulong families, const PRIVATE Closures* closures,
                      const PRIVATE Surfaces* surfaces, PRIVATE ControlLanes* controls) {
  clear_controls(controls);
#define CONTROL_IF_THERE(name, NAME)                     \
  if (HAS_FAMILY(NAME) && (families & ONLY(NAME)) != 0u) \
    control_##name##_lanes(scene, closures, surfaces, controls);
  LTC_FAMILIES(CONTROL_IF_THERE)
#undef CONTROL_IF_THERE
}

/// The control lobes of a single closure, for the cosine of wo.
FN ControlLobes control_of(const PRIVATE Scene* scene, Closure c, float cosine) {
  switch (c.family) {
#define CONTROL_ONE(name, NAME) \
  case FAMILY_##NAME:           \
    return name##_control(scene, c, cosine);
    LTC_FAMILIES(CONTROL_ONE)
#undef CONTROL_ONE
    default:
      return no_control_lobes();
  }
}

PENUMBRA_NAMESPACE_END
#endif
