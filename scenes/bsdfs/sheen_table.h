// The sheen of Zeltner, Burley and Chiang 2022 ("Practical multiple-scattering sheen using linearly
// transformed cosines"), fitted by fit_sheen.cpp.
#pragma once

namespace penumbra {

/// What fuzz reflects for a viewer, and the matrix of its transformed cosine, see kernels/bsdf/fuzz.h.
struct SheenCell {
  float reflectance, narrow, lean;
};

/// Between the table's cells, for a roughness and a cosine in [0, 1].
SheenCell sheen_cell(double roughness, double cosine);

}  // namespace penumbra
