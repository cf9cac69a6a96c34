// Grids of pbrt's media: the procedural cloud, grids on finer cells, and the light of hot ones.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "scenes/grid_volume.h"

namespace penumbra::pbrt {

/// pbrt's procedural cloud (Pharr, Jakob and Humphreys, Physically Based Rendering, 4th edition, section
/// 11.4.6).
struct Cloud {
  double density = 1.0, wispiness = 1.0, frequency = 5.0;
  /// The density at `place`, in [0, 1]. y is up, and the density decreases towards y = 1. The noise is of the
  /// same kind as pbrt's, but with other random numbers.
  [[nodiscard]] double at(const glm::dvec3& place) const;
};

/// The cloud over the box from `low` to `high`, as a grid with 128 cells along its longest side.
VolumeGrid cloud_grid(const Cloud& cloud, const glm::dvec3& low, const glm::dvec3& high);

/// How many times finer cells an rgbgrid gets along each axis. pbrt interpolates scattering and absorption,
/// we their sum and the share of one, which is the same on fine cells.
int refinement_of(const VolumeGrid& size);

/// The values of cells `finer` times as small as those of a grid of that size: at their centres, interpolated
/// as pbrt does, towards cells of value 0 around the grid.
std::vector<float> refined(const std::vector<float>& values, const VolumeGrid& size, int channels, int finer);

/// The temperature in kelvins that a number of a grid stands for: (number - offset) * scale.
struct TemperatureScale {
  double offset = 0.0, scale = 1.0;
};

/// What a medium emits by its temperature, for an absorption coefficient of 1: black bodies whose spectra
/// have the maximum 1 (unit_blackbody_to_rgb), above 100 K, times `strengths`, whose grid fills the same box,
/// and `factor`. pbrt interpolates temperatures; here colours are, on cells that are finer if the grid is
/// small (refinement_of). `film_colour`: an emitted colour as the film sees it.
VolumeGrid black_body_grid(const VolumeGrid& temperatures, const TemperatureScale& kelvins,
                           const std::optional<VolumeGrid>& strengths, const glm::vec3& factor,
                           const std::function<glm::vec3(const glm::vec3&)>& film_colour);

}  // namespace penumbra::pbrt
