// Made-up radiance in the form in which a device returns it. Needs no renderer.
#pragma once

#include "kernels/host/sample_buffer.h"
#include "tests/support/film_layers.h"
#include "worker/device.h"

namespace penumbra {

/// Statistics of hash-valued samples: a pure function of pixel, sample range and plane. Now and then a
/// sample counts as NaN. Means of radiance are in [shift, shift + 1).
SampleBuffer fake_samples(const RenderUnit& unit, const FilmLayers& layers, float shift = 0);

}  // namespace penumbra
