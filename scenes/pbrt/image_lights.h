// Lights of pbrt whose strength in each direction is an image's.
#pragma once

#include "scenes/pbrt/texture_reader.h"

namespace penumbra::pbrt {

/// Of a directive LightSource of that type.
void read_infinite(Context& context, TextureReader& textures, Parameters& parameters,
                   const GraphicsState& state, SourceLocation location);
/// An image across a beam.
void read_projection(Context& context, TextureReader& textures, Parameters& parameters,
                     const GraphicsState& state, SourceLocation location);
/// An octahedral image about a point, as six beams.
void read_goniometric(Context& context, TextureReader& textures, Parameters& parameters,
                      const GraphicsState& state, SourceLocation location);

/// Where on an equal-area octahedral image, in [0, 1]², a direction is: z > 0 in the diamond in the middle
/// (Clarberg, Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD, 2008).
glm::dvec2 octahedral_square(glm::dvec3 direction);

}  // namespace penumbra::pbrt
