// Reads the materials of pbrt.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "scenes/measured_file.h"
#include "scenes/pbrt/texture_reader.h"

namespace penumbra::pbrt {

class MaterialReader {
 public:
  MaterialReader(Context& context, TextureReader& textures) : context_(context), textures_(textures) {}

  /// Registers a Material directive and returns its number. It is read in finish(), when its textures and the
  /// materials that it mixes are known.
  int declare(std::string type, Parameters parameters, SourceLocation location);
  void declare_named(const std::string& name, std::string type, Parameters parameters,
                     SourceLocation location);
  /// The number of the material with that name, which may be defined later in the file.
  int refer(const std::string& name, SourceLocation location);

  /// Reads all materials; problems are reported. material() is valid only after this call.
  void finish();
  /// The material of that number. A diffuse one, after an error, if its name is not defined.
  std::shared_ptr<const SurfaceMaterial> material(int number);

 private:
  struct Entry {
    std::string type;
    Parameters parameters;
    SourceLocation location;
    bool is_reference = false;  ///< `type` is the name of another material
    bool is_begun = false;
    std::shared_ptr<const SurfaceMaterial> material;
  };
  std::shared_ptr<const SurfaceMaterial> named(const std::string& name, SourceLocation location);
  std::shared_ptr<const SurfaceMaterial> read(const std::string& type, Parameters& parameters,
                                              SourceLocation location);
  SurfaceMaterial diffuse(Parameters& parameters, SourceLocation location);
  SurfaceMaterial conductor(Parameters& parameters, SourceLocation location);
  SurfaceMaterial coated_diffuse(Parameters& parameters, SourceLocation location);
  SurfaceMaterial coated_conductor(Parameters& parameters, SourceLocation location);
  SurfaceMaterial dielectric(Parameters& parameters, SourceLocation location) {
    return dielectric(parameters, location, 1.5);
  }
  SurfaceMaterial dielectric(Parameters& parameters, SourceLocation location, double fallback);
  SurfaceMaterial thin_dielectric(Parameters& parameters, SourceLocation location);
  SurfaceMaterial diffuse_transmission(Parameters& parameters, SourceLocation location);
  SurfaceMaterial subsurface(Parameters& parameters, SourceLocation location);
  /// `radius`: mean free path of each colour.
  SurfaceMaterial textured_subsurface(Parameters& parameters, SourceLocation location,
                                      const TexturedColour& colour, const glm::vec3& radius, float g);
  SurfaceMaterial hair(Parameters& parameters, SourceLocation location);
  SurfaceMaterial measured(Parameters& parameters, SourceLocation location);
  SurfaceMaterial mix(Parameters& parameters, SourceLocation location);
  ConductorSurface conductor_surface(Parameters& parameters, const std::string& prefix,
                                     SourceLocation location);
  SurfaceMaterial plastic_with(Parameters& parameters, const TexturedColour& colour, double optical_depth,
                               SourceLocation location);
  /// The optical depth of a coating along its normal, without what it scatters.
  double coating_depth(Parameters& parameters, SourceLocation location);
  /// The refractive index at the Fraunhofer line d. `abbe`: where to put the Abbe number of a glass that
  /// disperses light; null: the surface has one index at all wavelengths.
  double index(Parameters& parameters, std::string_view name, SourceLocation location, double fallback = 1.5,
               float* abbe = nullptr);
  struct Roughness {
    TexturedNumber u, v;
    [[nodiscard]] bool smooth() const;
  };
  static SurfaceMaterial metal_of(const ConductorSurface& metal, const Roughness& rough);
  Roughness roughness(Parameters& parameters, const std::string& prefix, SourceLocation location);

  Context& context_;
  TextureReader& textures_;
  std::vector<std::unique_ptr<Entry>> entries_;
  std::map<std::string, int> named_;
  MeasuredFiles measured_;
  /// Textures of reflectances under a coating by the texture, what the coating reflects of light from below
  /// and the depth at which light ends.
  std::map<std::tuple<int, double, std::int64_t>, std::optional<int>> cut_;
};

}  // namespace penumbra::pbrt
