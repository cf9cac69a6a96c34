// Measured BRDFs of the RGL material database (.bsdf).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/file_access.h"

namespace penumbra {

/// The grids of a measured BRDF; see kernels/bsdf/measured.h. Directions are those of wo.
struct MeasuredBrdf {
  /// Grids over the unit square, one after the other; x fastest. At least 2 knots along each side.
  struct Grids {
    int columns = 2, rows = 2;
    std::vector<float> values;
    [[nodiscard]] std::size_t knots() const { return std::size_t(columns) * std::size_t(rows); }
  };

  std::vector<float> phi, theta;  ///< in radians, ascending; one azimuth or two: the material is isotropic
  Grids ndf, sigma;               ///< one each
  Grids vndf, luminance;          ///< for each phi and theta, theta fastest
  std::vector<float> colours;     ///< as luminance, but with three channels at each knot; linear Rec. 709
  bool by_facets = true;          ///< f cos is the colour times ndf / (4 sigma), not the colour alone

  [[nodiscard]] bool is_isotropic() const { return phi.size() <= 2; }
};

/// Reads a file, with the fields theta_i, phi_i, ndf, sigma, vndf, luminance, jacobian, and rgb, or spectra
/// and wavelengths, which become their colour under D65; spectra go on as at their ends. Colours below 0
/// become 0. Errors, which begin with `name` and name the field: those of read_tensors; a field that is
/// missing or has another type or shape; more knots than kernels have; a number that is not finite; angles or
/// wavelengths that do not ascend, or angles beyond the hemisphere; densities below 0.
Expected<MeasuredBrdf> read_measured_file(const std::string& name, std::string_view bytes);

/// Reads each file once.
class MeasuredFiles {
 public:
  /// Errors: those of FileAccess::read_bytes and of read_measured_file.
  Expected<std::shared_ptr<const MeasuredBrdf>> read(const FileAccess& files,
                                                     const std::filesystem::path& path);

 private:
  std::map<std::string, Expected<std::shared_ptr<const MeasuredBrdf>>> known_;  ///< by canonical paths
};

}  // namespace penumbra
