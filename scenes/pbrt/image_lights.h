// Lights of pbrt whose strength in each direction is given by an image.
#pragma once

#include "scenes/pbrt/texture_reader.h"

namespace penumbra::pbrt {

/// Reads an infinite light from a LightSource directive.
void read_infinite(Context& context, TextureReader& textures, Parameters& parameters,
                   const GraphicsState& state, SourceLocation location);
/// Reads a projection light: an image across a beam.
void read_projection(Context& context, TextureReader& textures, Parameters& parameters,
                     const GraphicsState& state, SourceLocation location);
/// Reads a goniometric light: an octahedral image around a point, represented by six projectors.
void read_goniometric(Context& context, TextureReader& textures, Parameters& parameters,
                      const GraphicsState& state, SourceLocation location);

/// The position of a direction in an equal-area octahedral image, in [0, 1]². Directions with z > 0 are in
/// the central diamond (Clarberg, Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD, 2008).
glm::dvec2 octahedral_square(glm::dvec3 direction);

}  // namespace penumbra::pbrt
