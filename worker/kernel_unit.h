// Converts a unit to the kernels' struct.
#pragma once

#include "kernels/unit.h"
#include "worker/device.h"

namespace penumbra {

inline Unit kernel_unit(const RenderUnit& unit) {
#define SAME_FIELD(type, name) .name = unit.name,
  return {UNIT_FIELDS(SAME_FIELD)};
#undef SAME_FIELD
}

}  // namespace penumbra
