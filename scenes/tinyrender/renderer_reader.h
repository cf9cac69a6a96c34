// [renderer] of a TinyRender scene: how it is rendered.
#pragma once

#include "scenes/tinyrender/section.h"

namespace penumbra::tinyrender {

/// Reads `type`, its parameters, and `spp`:
///  - direct: `samplingStrategy` chooses among samples of emitters (by area or solid angle), of the BSDF, and
///  of
///    the hemisphere (uniform or by cosine), or both kinds together with the balance heuristic ("mis");
///  - polygonal: `method` chooses the closed form, samples by area, or control variates. A scene for the
///  window
///    (`realtime`) without a method is rendered as what the window would show: the closed form, or with
///    `test` what its hybrid mode converges to;
///  - path: `maxDepth` counts bounces in TinyRender, and edges of the path, one more, here.
void read_renderer(const Context& context, SceneDescription& scene);

}  // namespace penumbra::tinyrender
