// The interface to OpenVDB files (.vdb): reads the grid of a medium. The code lives in a separate module. It
// is loaded when a scene refers to such a file, and it exists only if OpenVDB was present when the renderer
// was built.
#pragma once

#include <string>

#include "kernels/host/error.h"
#include "scenes/volume_file.h"

namespace penumbra {

/// The interface that the module exports under the name penumbra_vdb_reader.
struct VdbReader {
  /// Reads the grid named "density", or else the file's only grid of floats or of vectors of three. Returns
  /// the bounding box of its active voxels as a dense grid, and its position. Errors: no such grid, a level
  /// set, a transform that rotates, shears or mirrors the box, more than 2^28 numbers in the box, a number
  /// that is not finite, a damaged file.
  Expected<VolumeFile> (*read)(const std::string& bytes);
};

}  // namespace penumbra
