// The layers of films that tests make up.
#pragma once

#include "kernels/host/sample_buffer.h"

namespace penumbra {

inline constexpr FilmLayers kNoLayers, kFeatureLayers(FEATURE_LAYERS),
    kPolygonLayers(FEATURE_LAYERS | FEATURE_POLYGONS);

}  // namespace penumbra
