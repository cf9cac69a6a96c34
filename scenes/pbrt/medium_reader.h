// Reads the media of pbrt.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "scenes/pbrt/medium_grids.h"
#include "scenes/pbrt/texture_reader.h"

namespace penumbra::pbrt {

class MediumReader {
 public:
  explicit MediumReader(Context& context) : context_(context) {}

  /// Reads a MakeNamedMedium directive. Problems are reported.
  void make(const std::string& name, Parameters& parameters, const GraphicsState& state,
            SourceLocation location);

  /// The index of the medium in the scene, to which it is added. kNoMedium for an empty name, for a medium
  /// that is left out, and, with an error, for an undefined name. Call it after the whole file was read.
  int install(const std::string& name, SourceLocation location);

  [[nodiscard]] bool any_installed() const { return !context_.scene.media.empty(); }

 private:
  using Medium = std::optional<ParticipatingMedium>;
  Medium homogeneous(Parameters& parameters, const GraphicsState& state, SourceLocation location);
  Medium uniform_grid(Parameters& parameters, const GraphicsState& state, SourceLocation location);
  Medium rgb_grid(Parameters& parameters, const GraphicsState& state, SourceLocation location);
  Medium sparse_grid(Parameters& parameters, const GraphicsState& state, SourceLocation location);
  Medium cloud(Parameters& parameters, const GraphicsState& state, SourceLocation location);
  /// Returns the absorption coefficient.
  glm::vec3 read_coefficients(Parameters& parameters, const glm::vec3& scattered, const glm::vec3& absorbed,
                              ParticipatingMedium& medium, SourceLocation location);
  glm::vec3 emitted_radiance(Parameters& parameters);
  double emission_scale(Parameters& parameters, SourceLocation location);
  TemperatureScale temperature_scale(Parameters& parameters);
  /// The emission of a uniformgrid.
  void read_emission(Parameters& parameters, const VolumeGrid& size, const glm::dmat4& place,
                     const glm::vec3& absorbed, ParticipatingMedium& medium);
  /// Sets the emission to that of a grid of colours, unless it is black everywhere.
  void set_emission(VolumeGrid colours, const glm::dmat4& place, bool by_density, ParticipatingMedium& medium,
                    SourceLocation location);
  [[nodiscard]] glm::vec3 film_colour(const glm::vec3& colour) const;
  glm::vec3 coefficient(Parameters& parameters, const char* name, const glm::vec3& fallback);
  double scale(Parameters& parameters, SourceLocation location);
  std::optional<std::vector<float>> cells(Parameters& parameters, const char* name, const char* type,
                                          std::size_t channels, const VolumeGrid& size);
  std::optional<VolumeGrid> grid_size(Parameters& parameters, SourceLocation location);
  std::optional<glm::dmat4> grid_place(Parameters& parameters, const GraphicsState& state,
                                       SourceLocation location);

  struct Entry {
    Medium medium;
    int index = kNoMedium;
  };
  Context& context_;
  std::map<std::string, Entry> media_;
};

}  // namespace penumbra::pbrt
