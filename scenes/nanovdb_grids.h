// Grids of NanoVDB files (.nvdb), as grids of OpenVDB's.
#pragma once

#include <openvdb/openvdb.h>

#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

/// All grids of the file. Like OpenVDB, NanoVDB trusts its input. Errors: another version of the format, a
/// damaged file, or a build without NanoVDB.
Expected<openvdb::GridPtrVec> nanovdb_grids(std::string_view bytes);

}  // namespace penumbra
