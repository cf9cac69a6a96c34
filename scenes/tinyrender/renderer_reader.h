// Reads [renderer] of a TinyRender scene: the integrator.
#pragma once

#include "scenes/tinyrender/section.h"

namespace penumbra::tinyrender {

/// Reads `type`, its parameters, and `spp`:
///   - direct: `samplingStrategy` selects emitter sampling (by area or solid angle), BSDF sampling,
///     hemisphere sampling (uniform or by cosine), or both emitter and BSDF sampling with the balance
///     heuristic ("mis").
///   - polygonal: `method` selects the closed form, area sampling, or control variates. A scene for the
///     interactive window (`realtime`) without a method is rendered as the window would show it: by the
///     closed form, or with `test` as the limit to which its hybrid mode converges.
///   - path: `maxDepth` counts bounces in TinyRender, but edges of the path here, which is one more.
void read_renderer(const Context& context, SceneDescription& scene);

}  // namespace penumbra::tinyrender
