// BRDFs of files of measurements.
#pragma once

#include <memory>
#include <string>

#include "scenes/bsdfs/material.h"
#include "scenes/bsdfs/material_tables.h"
#include "scenes/bsdfs/measured_table.h"
#include "scenes/measured_file.h"
#include "scenes/plugin_values.h"

namespace penumbra {

/// A measured material of the RGL database (Dupuy and Jakob 2018), see kernels/bsdf/measured.h; as in
/// Mitsuba 3.
struct MeasuredBsdf {
  static constexpr const char* kPlugin = "measured";
  static constexpr const char* kText = "measured material of the RGL database";
  std::string filename;  ///< after reading, its path
  std::shared_ptr<const MeasuredBrdf> brdf;

  template <typename Row>
  static void parameters(const Row& row) {
    row("filename", &MeasuredBsdf::filename, FileName{}, "file of the database (.bsdf), rgb or spectral");
  }
};

inline Material material_of(const MeasuredBsdf& measured, MaterialTables& tables) {
  Material m = material_of_family(FAMILY_MEASURED);
  m.specular = to_vec3(measured_albedo(*measured.brdf));
  m.anisotropic = measured.brdf->phi.size() > 1 ? 1.0f : 0.0f;
  m.curve = tables.measured(measured.brdf);
  return m;
}

}  // namespace penumbra
