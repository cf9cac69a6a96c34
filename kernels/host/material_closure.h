// The closure of a material without textures, for host code.
#pragma once

#include "kernels/scene_types.h"

namespace penumbra {

inline Closure closure_of(const Material& m) {
  Closure c;
#define COPY_FIELD(_, type, name) c.name = m.name;
  CLOSURE_FIELDS(COPY_FIELD, _)
#undef COPY_FIELD
  return c;
}

}  // namespace penumbra
