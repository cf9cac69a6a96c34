// Lights of pbrt.
#pragma once

#include "scenes/pbrt/texture_reader.h"

namespace penumbra::pbrt {

/// Of a directive LightSource.
void read_light(Context& context, TextureReader& textures, const std::string& type, Parameters& parameters,
                const GraphicsState& state, SourceLocation location);

/// Of a directive AreaLightSource; none, and an error, of another type.
std::shared_ptr<const AreaLight> read_area_light(Context& context, TextureReader& textures,
                                                 const std::string& type, Parameters& parameters,
                                                 SourceLocation location);

}  // namespace penumbra::pbrt
