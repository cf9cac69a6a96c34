// Results of the right size that cost no time.
#pragma once

#include "kernels/host/sample_buffer.h"
#include "worker/device.h"

namespace penumbra {

/// Every value of a plane is the same, and a function of the unit's place and samples.
SampleBuffer load_samples(const RenderUnit& unit, int planes);

/// What a unit takes, within 20% of the mean, so that workers do not go in step.
double load_seconds(const RenderUnit& unit, double mean);

}  // namespace penumbra
