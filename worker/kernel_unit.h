// Converts a unit to the kernels' struct.
#pragma once

#include "kernels/unit.h"
#include "worker/device.h"

namespace penumbra {

inline Unit kernel_unit(const RenderUnit& unit) {
  return {.x = unit.x,
          .y = unit.y,
          .width = unit.width,
          .height = unit.height,
          .first_sample = unit.first_sample,
          .sample_count = int(unit.sample_count),
          .sequence = unit.sequence,
          .spp = unit.spp};
}

}  // namespace penumbra
