// Participating media as scene files describe them, and the parameters of their plugins, one table row for
// each (see bsdfs.h).
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/diagnostic.h"
#include "scenes/grid_volume.h"
#include "scenes/plugin_values.h"
#include "scenes/scattering.h"
#include "scenes/volumes.h"

namespace penumbra {

constexpr int kNoMedium = -1;

/// A participating medium. Its phase function is a mixture of lobes, stored as the kernels' records.
struct ParticipatingMedium {
  std::string name;            ///< the id in the scene file, or a description of the location; for messages
  glm::vec3 extinction{1.0f};  ///< extinction coefficient, in 1 / scene unit, at least 0
  glm::vec3 albedo{0.75f};     ///< single-scattering albedo, in [0, 1]
  std::optional<GridVolume> density{};      ///< multiplies the extinction; outside its box there is no medium
  std::optional<GridVolume> albedo_grid{};  ///< multiplies the albedo; values in [0, 1]
  /// Emitted radiance per scene unit, at least 0: of a medium in which the radiance does not change it is the
  /// absorption coefficient times that radiance. It ends where the density's box does.
  glm::vec3 emission{0.0f};
  std::optional<GridVolume> emission_grid{};  ///< multiplies the emission; there is none outside of its box
  bool emission_by_density = false;           ///< the density multiplies the emission, too
  /// 1 to PHASE_LOBES lobes, all different; the weights are positive and sum to 1
  std::vector<PhaseLobe> phase{};
  /// It is the inside of a material, which all integrators that follow paths see.
  bool of_material = false;
  [[nodiscard]] bool emits() const { return emission != glm::vec3(0.0f); }
};

inline bool operator==(const PhaseLobe& a, const PhaseLobe& b) {
  return a.kind == b.kind && a.g == b.g && a.weight == b.weight;
}

/// The coefficients that media of both kinds have: the extinction, constant or a grid, and the albedo.
template <typename Extinction>
struct MediumCoefficients {
  Extinction sigma_t{glm::vec3(1.0f)};
  GriddedColour albedo{glm::vec3(0.75f)};
  float scale = 1.0f;
  GriddedColour emission{glm::vec3(0.0f)};

  template <typename Row>
  static void parameters(const Row& row) {
    row("emission", &MediumCoefficients::emission, VolumeColour{{0.0f, kAnyNumber}, true},
        "emitted radiance per scene unit, which the scale does not multiply");
    row("sigma_t", &MediumCoefficients::sigma_t, VolumeColour{{0.0f, kAnyNumber}},
        "extinction in 1 / scene unit");
    row("albedo", &MediumCoefficients::albedo, VolumeColour{}, "the share of it that is scattered");
    row("scale", &MediumCoefficients::scale, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "by which the coefficients are multiplied");
  }
  void check_extinction(Findings& findings) const {
    const glm::vec3 most = scale * GriddedColour(sigma_t).most();
    if (!std::isfinite(most.x) || !std::isfinite(most.y) || !std::isfinite(most.z))
      findings.push_back({"scale", "the extinction is too large for a number"});
  }
  /// The medium, still without a name and a phase function.
  [[nodiscard]] ParticipatingMedium medium() const {
    const GriddedColour extinction(sigma_t);
    ParticipatingMedium result;
    result.extinction = scale * extinction.value;
    result.albedo = albedo.value;
    result.density = extinction.grid;
    result.albedo_grid = albedo.grid;
    result.emission = emission.value;
    result.emission_grid = emission.grid;
    return result;
  }
};

struct HomogeneousMedium : MediumCoefficients<glm::vec3> {
  static constexpr const char* kPlugin = "homogeneous";
  static constexpr const char* kText =
      "medium that is the same everywhere; sigma_t and albedo, or sigma_s and sigma_a; albedo and "
      "emission may be a gridvolume; holds a phase function";
  glm::vec3 sigma_s{0.0f}, sigma_a{0.0f};
  std::string material;
  bool by_material = false;  ///< of a file whose version knows named materials

  template <typename Row>
  static void parameters(const Row& row) {
    MediumCoefficients::parameters(row);
    row("sigma_s", &HomogeneousMedium::sigma_s, VolumeColour{{0.0f, kAnyNumber}},
        "scattering coefficient, instead of sigma_t and albedo");
    row("sigma_a", &HomogeneousMedium::sigma_a, VolumeColour{{0.0f, kAnyNumber}}, "... and what is absorbed");
    row("material", &HomogeneousMedium::material, AnyText{"name of a material"},
        "measured coefficients in 1 / mm of a material such as skin1, instead; of version 0.x");
  }
  void written_for(std::int64_t version) { by_material = version < 2; }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    bool parts = given("sigma_s") || given("sigma_a");
    const bool whole = given("sigma_t") || given("albedo");
    if (given("material") && (parts || whole || !by_material))
      findings.push_back({"material", by_material ? "either a material, or coefficients"
                                                  : "only files of version 0.x name a medium's material"});
    // Without any, Mitsuba 0.x takes this material.
    if (by_material && !parts && !whole) {
      const std::string name = given("material") ? material : "skin1";
      const auto measured = jensen_scattering_of(name);
      if (!measured)
        findings.push_back(
            {"material", fmt::format("the scattering of '{}' is not known{}", name,
                                     known_names(name, jensen_scattering_names(), "It is of"))});
      if (measured) sigma_s = measured->scattered;
      if (measured) sigma_a = measured->absorbed;
      parts = true;
    } else if (parts && whole)
      findings.push_back({"", "either sigma_t and albedo, or sigma_s and sigma_a"});
    else if (parts && !(given("sigma_s") && given("sigma_a")))
      findings.push_back({"", "sigma_s and sigma_a go together"});
    if (parts) sigma_t = sigma_s + sigma_a;
    for (int i = 0; parts && i < 3; ++i) albedo.value[i] = sigma_t[i] > 0 ? sigma_s[i] / sigma_t[i] : 0.0f;
    check_extinction(findings);
  }
};

struct HeterogeneousMedium : MediumCoefficients<GriddedColour> {
  static constexpr const char* kPlugin = "heterogeneous";
  static constexpr const char* kText =
      "medium that varies in space; sigma_t is a gridvolume or a constvolume, outside of whose box there is "
      "nothing, and albedo and emission may be one; holds a phase function";

  template <typename Row>
  static void parameters(const Row& row) {
    MediumCoefficients::parameters(row);
    row("emission_by_density", &HeterogeneousMedium::emission_by_density, TrueOrFalse{},
        "the grid of sigma_t multiplies the emission, too");
  }
  void complete(Findings& findings) {
    check_extinction(findings);
    if (sigma_t.grid) return;
    // As in Mitsuba 3, a constant medium also ends at the unit cube of its to_world.
    static const auto kOne = std::make_shared<const VolumeGrid>(VolumeGrid{1, 1, 1, 1, {1.0f}});
    density = GridVolume{kOne, sigma_t.to_world};
  }
  [[nodiscard]] ParticipatingMedium medium() const {
    ParticipatingMedium result = MediumCoefficients::medium();
    if (density) result.density = density;
    result.emission_by_density = emission_by_density;
    return result;
  }
  bool emission_by_density = false;
  std::optional<GridVolume> density{};  ///< for a constant sigma_t: the box to which the medium is confined
};

struct IsotropicPhase {
  static constexpr const char* kPlugin = "isotropic";
  static constexpr const char* kText = "isotropic scattering; of media that hold no phase function";
  template <typename Row>
  static void parameters(const Row&) {}
  [[nodiscard]] PhaseLobe lobe() const { return {PHASE_HG, 0.0f, 1.0f}; }
};

struct HenyeyGreensteinPhase {
  static constexpr const char* kPlugin = "hg";
  static constexpr const char* kText = "Henyey-Greenstein phase function";
  double g = 0.8;
  template <typename Row>
  static void parameters(const Row& row) {
    row("g", &HenyeyGreensteinPhase::g, AnyNumber{"number in (-1, 1)"}, "the mean cosine");
  }
  void complete(Findings& findings) const {
    if (!(std::abs(float(g)) < 1.0f))
      findings.push_back({"g", fmt::format("g must be a number in (-1, 1), not {}", g)});
  }
  [[nodiscard]] PhaseLobe lobe() const { return {PHASE_HG, float(g), 1.0f}; }
};

struct RayleighPhase {
  static constexpr const char* kPlugin = "rayleigh";
  static constexpr const char* kText = "Rayleigh scattering";
  template <typename Row>
  static void parameters(const Row&) {}
  [[nodiscard]] PhaseLobe lobe() const { return {PHASE_RAYLEIGH, 0.0f, 1.0f}; }
};

struct BlendPhase {
  static constexpr const char* kPlugin = "blendphase";
  static constexpr const char* kText = "two phase functions, mixed by a weight; they may be blends again";
  glm::vec3 weight{0.5f};
  template <typename Row>
  static void parameters(const Row& row) {
    row("weight", &BlendPhase::weight, VolumeColour{}, "share of the second, the same for all colours");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) const {
    if (!given("weight")) findings.push_back({"", "blendphase needs a weight"});
    if (weight != glm::vec3(weight.x)) findings.push_back({"weight", "weight must be a number, no colour"});
  }
};

using PhasePlugins = std::variant<IsotropicPhase, HenyeyGreensteinPhase, RayleighPhase>;
using MediumKinds = std::variant<HomogeneousMedium, HeterogeneousMedium>;
using MediumPlugins = std::variant<HomogeneousMedium, HeterogeneousMedium, GridVolumeParameters,
                                   IsotropicPhase, HenyeyGreensteinPhase, RayleighPhase, BlendPhase>;

}  // namespace penumbra
