// Made-up radiance: what a device would return, without a renderer.
#pragma once

#include "kernels/host/sample_buffer.h"
#include "worker/device.h"

namespace penumbra {

/// Statistics of hash-valued samples: a pure function of pixel, sample range and plane count. Now and then a
/// sample counts as NaN. Means of radiance are in [shift, shift + 1).
SampleBuffer fake_samples(const RenderUnit& unit, int planes, float shift = 0);

}  // namespace penumbra
