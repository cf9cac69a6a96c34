// OpenVDB's files (.vdb): of sparse numbers on a grid, what a medium takes of them. Behind a module that is
// loaded once a scene names such a file, and that is there where OpenVDB was when it was built.
#pragma once

#include <string>

#include "kernels/host/error.h"
#include "scenes/volume_file.h"

namespace penumbra {

/// What the module offers, under the name penumbra_vdb_reader.
struct VdbReader {
  /// Of the file's grids that named "density", or else its only one of floats or of vectors of three: the box
  /// of its active voxels, dense, and where that is. Errors: no such grid, a level set, a transform that
  /// turns, shears or mirrors the box, more than 2^28 numbers in it, a number that is not finite, a damaged
  /// file.
  Expected<VolumeFile> (*read)(const std::string& bytes);
};

}  // namespace penumbra
