// Changes to a scene for a preview, whose samples a window requests one by one.
#pragma once

#include <functional>

#include "scenes/scene_description.h"
#include "scheduler/cli/render_options.h"

namespace penumbra {

/// Samples of a pixel that a preview may come to, unless --spp says otherwise.
constexpr std::uint32_t kPreviewSpp = 4096;

/// Direct light of polygons alone becomes polygon_cv with a given alpha, so that a window can draw the closed
/// form itself; other scenes stay what they are. The number of samples becomes kPreviewSpp, but for
/// stratified sampling, which has to know it.
std::function<void(SceneDescription&)> preview_adjustment(const SceneOptions& options);

}  // namespace penumbra
