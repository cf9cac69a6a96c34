// Volume files of Mitsuba (.vol), OpenVDB (.vdb) and NanoVDB (.nvdb): numbers on a grid.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>

#include "kernels/host/error.h"
#include "scenes/grid_volume.h"

namespace penumbra {

struct VolumeFile {
  VolumeGrid grid;                 ///< finite numbers, which may be negative
  glm::dvec3 low{0.0}, high{1.0};  ///< the bounding box that the file states; not validated
};

/// Reads a volume file. For OpenVDB and NanoVDB files see VdbReader. Mitsuba's format is: "VOL", the byte 3,
/// then in little-endian order the encoding 1 (single precision), the numbers of cells along x, y, z, the
/// number of channels, a box, and the numbers, x fastest, with all channels of a cell adjacent. Errors, which
/// begin with `name`: any other format, a file that is too short or too long, channels other than 1 or 3, a
/// number that is not finite.
Expected<VolumeFile> read_volume_file(const std::string& name, std::string_view bytes);

/// Reads the grid of that name, which is not empty, of an OpenVDB file. If there is none, and of Mitsuba's
/// files, whose grid has no name, an empty grid. Errors: as above.
Expected<VolumeFile> read_volume_grid(const std::string& name, std::string_view bytes, std::string_view grid);

/// The bytes of a Mitsuba volume file, from which read_volume_file restores the same grid.
std::string vol_of(const VolumeGrid& grid, const glm::dvec3& low = glm::dvec3(0.0),
                   const glm::dvec3& high = glm::dvec3(1.0));

/// The position of value number `index` in a grid, for messages: "x 1, y 0, z 2", with three channels
/// followed by ", channel 0". All count from 0.
std::string place_in_grid(const VolumeGrid& grid, std::size_t index);

}  // namespace penumbra
