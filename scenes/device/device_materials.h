// Fields of the kernels' materials that depend on the rest of the scene: on other materials and on images.
#pragma once

#include <vector>

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Sets which rays pass through a material, and through how many of its leaves, from its children. The
/// children come before it in the list.
void set_passes(Material& m, const std::vector<Material>& before);

/// What the material of a BSDF does with an interior that the integrator sees: what scatters below goes in,
/// and the colour of what is transmitted is that of the interior.
void set_interior(const Bsdf& bsdf, Material& m);

/// If the material is a thin pane, it then lets rays pass straight through with some probability, and is a
/// mirror for the others. Returns whether it is one.
bool open_pane(Material& m);

/// Whether plates of that material are flat glass for the kernels (flat_glass.h): a smooth dielectric without
/// textures, and no other material holds it.
bool is_glass(const std::vector<Material>& materials, int index);

/// Whether the mesh has flat sides, like a plate: a quarter of its area or more has the same normal, up to
/// its sign.
bool has_flat_sides(const Mesh& mesh);

/// Marks the materials of a shape of which both hold, so that shadow rays pass it. Returns whether they do.
bool mark_flat_glass(const Shape& shape, std::vector<Material>& materials);

/// The distance in texture coordinates of a bump map's finite differences. It is a small part of a texel,
/// because slopes change at the edges of texels.
float bend_step(const SceneDescription& scene, int texture);

/// Whether a material has control lobes that are so narrow that points on lights are better sampled according
/// to them. That takes twice the time; tests/benchmarks/glossy_variance_benchmark.cpp measured when it pays.
/// A textured parameter is judged by its constant value.
bool has_narrow_lobes(const std::vector<Material>& materials);

}  // namespace penumbra
