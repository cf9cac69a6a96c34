// Materials of pbrt.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "scenes/pbrt/texture_reader.h"

namespace penumbra::pbrt {

class MaterialReader {
 public:
  MaterialReader(Context& context, TextureReader& textures) : context_(context), textures_(textures) {}

  /// Of a directive Material; what is wrong with it is reported.
  std::shared_ptr<const SurfaceMaterial> read(const std::string& type, Parameters& parameters,
                                              SourceLocation location);
  void name(const std::string& name, std::shared_ptr<const SurfaceMaterial> material) {
    named_[name] = std::move(material);
  }
  /// The one of that name; one that is diffuse, and an error, where there is none.
  std::shared_ptr<const SurfaceMaterial> named(const std::string& name, SourceLocation location);

 private:
  SurfaceMaterial diffuse(Parameters& parameters, SourceLocation location);
  SurfaceMaterial conductor(Parameters& parameters, SourceLocation location);
  SurfaceMaterial coated_diffuse(Parameters& parameters, SourceLocation location);
  SurfaceMaterial coated_conductor(Parameters& parameters, SourceLocation location);
  SurfaceMaterial dielectric(Parameters& parameters, SourceLocation location);
  SurfaceMaterial thin_dielectric(Parameters& parameters, SourceLocation location);
  SurfaceMaterial mix(Parameters& parameters, SourceLocation location);
  SurfaceMaterial conductor_with(Parameters& parameters, const std::string& prefix, SourceLocation location);
  double index(Parameters& parameters, SourceLocation location);
  struct Roughness {
    TexturedNumber u, v;
    [[nodiscard]] bool smooth() const;
  };
  Roughness roughness(Parameters& parameters, const std::string& prefix, SourceLocation location);

  Context& context_;
  TextureReader& textures_;
  std::map<std::string, std::shared_ptr<const SurfaceMaterial>> named_;
};

}  // namespace penumbra::pbrt
