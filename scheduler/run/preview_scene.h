// Adapts a scene to an interactive preview, whose samples a window requests step by step.
#pragma once

#include <functional>

#include "scenes/scene_description.h"
#include "scheduler/run/render_options.h"

namespace penumbra {

/// The largest number of samples per pixel of a preview, unless --spp says otherwise.
constexpr std::uint32_t kPreviewSpp = 4096;

/// If the scene has only direct illumination by polygons, the integrator becomes polygon_cv with a fixed
/// alpha, so that a window can draw the closed form itself. The number of samples becomes kPreviewSpp, except
/// for stratified sampling, which must know it in advance.
std::function<void(SceneDescription&)> preview_adjustment(const SceneOptions& options);

}  // namespace penumbra
