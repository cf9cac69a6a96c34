// What materials of the kernels have from the scene around them: the materials and images that they refer to.
#pragma once

#include <vector>

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// How many rays pass through a material, by its children, which come before it.
void set_passes(Material& m, const std::vector<Material>& before);

/// In scenes with media rays pass thin panes by chance, straight on, and the others meet a mirror.
void open_pane(Material& m);

/// Between texture coordinates whose heights are compared: a small part of a texel, across whose edges slopes
/// change.
float bend_step(const SceneDescription& scene, int texture);

/// Whether a material has control lobes so narrow that points of lights are better chosen by them, which
/// takes twice the time: measured by tests/benchmarks/glossy_variance_benchmark.cpp. Textures count as what
/// their place is in the material.
bool has_narrow_lobes(const std::vector<Material>& materials);

}  // namespace penumbra
