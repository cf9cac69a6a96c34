#include "scenes/nanovdb_grids.h"

#ifdef PENUMBRA_HAS_NANOVDB
  #include <nanovdb/util/IO.h>
  #include <nanovdb/util/NanoToOpenVDB.h>

  #include <sstream>
#endif

namespace penumbra {

#ifdef PENUMBRA_HAS_NANOVDB

namespace {

/// The grid of the handle as one of OpenVDB's, if its numbers are of one of these types; else null.
template <typename... Numbers>
openvdb::GridBase::Ptr converted(const nanovdb::GridHandle<nanovdb::HostBuffer>& handle) {
  openvdb::GridBase::Ptr result;
  const auto add = [&]<typename Number>(const nanovdb::NanoGrid<Number>* grid) {
    if (grid != nullptr) result = nanovdb::nanoToOpenVDB(*grid);
  };
  (add(handle.template grid<Numbers>()), ...);
  return result;
}

}  // namespace

Expected<openvdb::GridPtrVec> nanovdb_grids(std::string_view bytes) {
  std::istringstream stream{std::string(bytes)};
  openvdb::GridPtrVec grids;
  for (const auto& handle : nanovdb::io::readGrids<nanovdb::HostBuffer, std::vector>(stream))
    if (auto grid = converted<float, nanovdb::Vec3f, nanovdb::Fp8, nanovdb::Fp16, nanovdb::FpN>(handle))
      grids.push_back(std::move(grid));
  return grids;
}

#else

Expected<openvdb::GridPtrVec> nanovdb_grids(std::string_view) {
  return fail(
      "it is a file of NanoVDB, without whose headers this program was built; OpenVDB's program "
      "nanovdb_convert "
      "makes a .vdb of it, which is read");
}

#endif

}  // namespace penumbra
