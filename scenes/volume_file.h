// Volume files, Mitsuba's (.vol) and OpenVDB's (.vdb): numbers on a grid.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>

#include "kernels/host/error.h"
#include "scenes/grid_volume.h"

namespace penumbra {

struct VolumeFile {
  VolumeGrid grid;                 ///< its numbers are finite, and may be below 0
  glm::dvec3 low{0.0}, high{1.0};  ///< the box that the file says, whatever it is
};

/// Of OpenVDB's files see VdbReader. Of Mitsuba's: "VOL", 3, then in little endian the encoding 1 (single
/// precision), the numbers of cells along x, y, z, the number of channels, a box, and the numbers, x fastest,
/// of each cell all channels. Errors, which begin with `name`: anything else, as many numbers as the file
/// does not have, channels other than 1 or 3, a number that is not finite.
Expected<VolumeFile> read_volume_file(const std::string& name, std::string_view bytes);

/// The bytes of such a file: read_volume_file makes the same grid of them.
std::string vol_of(const VolumeGrid& grid, const glm::dvec3& low = glm::dvec3(0.0),
                   const glm::dvec3& high = glm::dvec3(1.0));

/// Where the number `index` among a grid's is, for messages: "x 1, y 0, z 2", with three channels ", channel
/// 0" after it, all from 0.
std::string place_in_grid(const VolumeGrid& grid, std::size_t index);

}  // namespace penumbra
