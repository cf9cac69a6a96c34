// Layers of the films that tests make.
#pragma once

#include "kernels/host/sample_buffer.h"

namespace penumbra {

inline constexpr FilmLayers kNoLayers, kFeatureLayers(FEATURE_LAYERS),
    kPolygonLayers(FEATURE_LAYERS | FEATURE_POLYGONS);

}  // namespace penumbra
