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

/// Where on an equal-area octahedral image, in [0, 1]², a direction is: z > 0 in the diamond in the middle
/// (Clarberg, Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD, 2008).
glm::dvec2 octahedral_square(glm::dvec3 direction);

}  // namespace penumbra::pbrt
