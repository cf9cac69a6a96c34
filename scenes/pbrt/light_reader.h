// Reads the lights of pbrt.
#pragma once

#include "scenes/pbrt/texture_reader.h"

namespace penumbra::pbrt {

/// Reads a LightSource directive.
void read_light(Context& context, TextureReader& textures, const std::string& type, Parameters& parameters,
                const GraphicsState& state, SourceLocation location);

/// Reads an AreaLightSource directive. Null, and an error, for an unknown type.
std::shared_ptr<const AreaLight> read_area_light(Context& context, TextureReader& textures,
                                                 const std::string& type, Parameters& parameters,
                                                 SourceLocation location);

}  // namespace penumbra::pbrt
