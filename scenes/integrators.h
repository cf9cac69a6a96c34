// The integrators with their parameters, and one table row for every parameter. A new parameter needs a
// member in every integrator that has it, and a row in integrator_rows.cpp. Scene files, --set, messages, the
// table of all settings, the render's record and the copy to the kernels are all generated from the row.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/setting_values.h"

namespace penumbra {

/// How a point on an area light is sampled: uniformly by area; by solid angle (rectangles, triangles and
/// spheres; disks by area); by projected solid angle (meshes; other shapes by solid angle); or by the method
/// that is best for the integrator.
enum class EmitterSampling { kAuto, kArea, kSolidAngle, kProjected };

enum class DirectSampling { kBsdfOnly, kEmitterOnly, kMis };  ///< path: "mats", "ems", "mis"
/// Path: which of the two sampling techniques contributes to the image, to see where its noise comes from.
enum class PathTechnique { kAll, kBsdf, kEmitter };
enum class MisHeuristic { kBalance, kPower };  ///< power: beta = 2
/// How direct samples the directions of `bsdf_samples`.
enum class BsdfSampling { kBsdf, kCosine, kUniform };
/// Path: kCv uses the closed form of polygon lights as a control variate.
enum class NextEvent { kSample, kCv };
/// How one of many lights is chosen: in proportion to its power, or to its unshadowed contribution at the
/// shading point.
enum class LightChoice { kAuto, kPower, kAnalytic, kTree };

enum class IndirectSampling { kBsdf, kCosine, kUniform };  ///< whitted: how indirect directions are sampled
enum class OcclusionSampling { kCosine, kHemisphere, kSphere };  ///< ao: the density of directions
enum class OcclusionWeighting { kCosine, kUniform };             ///< ao: the weight of a direction

/// What the camera sees of a hidden emitter: its surface without its emission (Mitsuba up to 3.6), or what is
/// behind it (later versions).
enum class HiddenEmitters { kUnlit, kLookedThrough };

/// Direct illumination by emitter samples and BSDF samples.
struct DirectIntegrator {
  static constexpr const char* kName = "direct";
  static constexpr const char* kText = "direct illumination, by samples of emitters and BSDFs";
  int emitter_samples = 1;  ///< emitter samples, n_g
  int bsdf_samples = 1;     ///< BSDF samples, n_f
  BsdfSampling bsdf_sampling = BsdfSampling::kBsdf;
  EmitterSampling emitter_sampling = EmitterSampling::kAuto;
  MisHeuristic heuristic = MisHeuristic::kBalance;
  LightChoice light_choice = LightChoice::kAuto;
  bool trace_shadows = true;
};

struct PathIntegrator {
  static constexpr const char* kName = "path";
  static constexpr const char* kText =
      "path tracing; direct_sampling and its other names choose the sampling strategies";
  /// Names of the integrator that also set direct_sampling.
  static constexpr std::pair<const char*, DirectSampling> kPresets[] = {
      {"path_mats", DirectSampling::kBsdfOnly},
      {"path_ems", DirectSampling::kEmitterOnly},
      {"path_mis", DirectSampling::kMis}};
  int max_depth = -1;  ///< in edges; -1: no limit
  int rr_depth = 2;    ///< Mitsuba's is 5, see "Russian roulette" in kernels/MEASUREMENTS.md
  DirectSampling direct_sampling = DirectSampling::kMis;
  EmitterSampling emitter_sampling = EmitterSampling::kAuto;
  MisHeuristic heuristic = MisHeuristic::kBalance;
  LightChoice light_choice = LightChoice::kAuto;
  NextEvent next_event = NextEvent::kSample;
  std::optional<float> alpha = std::nullopt;  ///< of the control variate; none: fitted
  int only_bounces = -1;  ///< keeps only light that was scattered by this many surfaces; -1: all light
  PathTechnique only_technique = PathTechnique::kAll;
};

/// The light transport of `path`, also through participating media.
struct VolpathIntegrator {
  static constexpr const char* kName = "volpath";
  static constexpr const char* kText = "path tracing through participating media";
  static constexpr std::pair<const char*, DirectSampling> kPresets[] = {
      {"volpath_mats", DirectSampling::kBsdfOnly},
      {"volpath", DirectSampling::kMis},
      {"volpathmis", DirectSampling::kMis}};
  int max_depth = -1;  ///< in edges; -1: no limit
  int rr_depth = 2;
  DirectSampling direct_sampling = DirectSampling::kMis;
  EmitterSampling emitter_sampling = EmitterSampling::kAuto;
  MisHeuristic heuristic = MisHeuristic::kBalance;
  LightChoice light_choice = LightChoice::kAuto;
  NextEvent next_event = NextEvent::kSample;
  std::optional<float> alpha = std::nullopt;  ///< of the control variate; none: fitted
};

/// Whether only a part of the light is kept.
constexpr bool keeps_parts(const PathIntegrator& path) {
  return path.only_bounces >= 0 || path.only_technique != PathTechnique::kAll;
}

/// Follows both reflection and transmission at mirrors and glass, and samples the hemisphere at other
/// surfaces. Its expected image is that of `path`.
struct WhittedIntegrator {
  static constexpr const char* kName = "whitted";
  static constexpr const char* kText = "path tracing that branches at mirrors, glass and other surfaces";
  int max_depth = -1;  ///< in edges; -1: no limit
  int rr_depth = 5;
  /// Number of surfaces at which a path branches; after that it samples one of the branches.
  int branch_depth = 4;
  int indirect_samples = 1;  ///< directions per surface that is not specular
  IndirectSampling indirect_sampling = IndirectSampling::kCosine;
  EmitterSampling emitter_sampling = EmitterSampling::kAuto;
  MisHeuristic heuristic = MisHeuristic::kBalance;
  LightChoice light_choice = LightChoice::kAuto;
  NextEvent next_event = NextEvent::kSample;
  std::optional<float> alpha = std::nullopt;  ///< of the control variate; none: fitted
};

/// Photon mapping with one map for the image (Jensen 1996): direct light by samples; caustics and other
/// indirect light by the densities of two maps.
struct PhotonMapIntegrator {
  static constexpr const char* kName = "photonmapper";
  static constexpr const char* kText = "photon mapping with one map for the image; biased";
  int max_depth = -1;  ///< in edges, those of the photon included; -1: no limit
  int rr_depth = 5;
  int global_photons = 250'000;   ///< paths of photons emitted for the global map
  int caustic_photons = 250'000;  ///< ... for the caustic map
  int volume_photons = 250'000;   ///< ... for the map of media
  /// Radii of density estimates, in radii of the scene's bounding sphere.
  float global_lookup_radius = 0.05f, caustic_lookup_radius = 0.0125f, volume_lookup_radius = 0.05f;
  float photon_radius = 0;    ///< the radius of all maps in scene units; 0: by the numbers above
  int lookup_size = 120;      ///< photons of a density estimate: at most so many, the nearest ones
  bool final_gather = false;  ///< the global map is seen from one diffuse bounce further
  EmitterSampling emitter_sampling = EmitterSampling::kAuto;
  MisHeuristic heuristic = MisHeuristic::kBalance;
  LightChoice light_choice = LightChoice::kAuto;
};

/// Probabilistic progressive photon mapping (Knaus and Zwicker 2011): a new map every few samples, with
/// shrinking radii. It converges to the image of `path`, or of `volpath` in scenes with media.
struct ProgressivePhotonIntegrator {
  static constexpr const char* kName = "ppm";
  static constexpr const char* kText = "progressive photon mapping; the bias vanishes with more samples";
  static constexpr const char* kAliases[] = {"pppm", "sppm"};
  int max_depth = -1;  ///< in edges, those of the photon included; -1: no limit
  int rr_depth = 5;
  int photon_count = 250'000;         ///< paths of photons emitted for each map
  float initial_radius = 0;           ///< in scene units; 0: from the size of a pixel
  std::optional<float> alpha = 0.7f;  ///< how fast radii shrink; none: 2/3
  bool caustics_only = false;         ///< photons bring caustics alone, and paths all other light
  EmitterSampling emitter_sampling = EmitterSampling::kAuto;
  MisHeuristic heuristic = MisHeuristic::kBalance;
  LightChoice light_choice = LightChoice::kAuto;
};

/// Ambient occlusion: the fraction of the directions above a surface in which no surface lies within
/// `ray_length`.
struct AmbientOcclusionIntegrator {
  static constexpr const char* kName = "ao";
  static constexpr const char* kText = "ambient occlusion";
  int vis_samples = 1;
  OcclusionSampling sampling = OcclusionSampling::kCosine;
  OcclusionWeighting weighting = OcclusionWeighting::kCosine;
  float ray_length = -1;  ///< scene units; negative: half the scene's radius; 0: no limit
  float background = 1;
};

/// Reflection occlusion: the unoccluded fraction of a Phong lobe around the mirror direction, weighted by the
/// cosine.
struct ReflectionOcclusionIntegrator {
  static constexpr const char* kName = "ro";
  static constexpr const char* kText = "reflection occlusion; for a Phong lobe about the mirror direction";
  int vis_samples = 1;
  float exponent = 30;
  float ray_length = 0;  ///< scene units; negative: half the scene's radius; 0: no limit
  float background = 0;
};

/// The absolute values of the shading normal's coordinates, black where there is no surface (Nori).
struct NormalsIntegrator {
  static constexpr const char* kName = "normals";
  static constexpr const char* kText = "shading normals as colours";
};

/// The unshadowed direct light of polygon lights in closed form.
struct PolygonAnalyticIntegrator {
  static constexpr const char* kName = "polygon_analytic";
  static constexpr const char* kText = "unshadowed light of polygon lights, in closed form";
};

/// Direct illumination by area sampling of emitters.
struct PolygonAreaIntegrator {
  static constexpr const char* kName = "polygon_area";
  static constexpr const char* kText = "direct light of polygon lights, by samples of their area";
  int emitter_samples = 1;
  EmitterSampling emitter_sampling = EmitterSampling::kAuto;
  LightChoice light_choice = LightChoice::kAuto;
  bool trace_shadows = true;
};

/// Direct illumination by emitter sampling, with the closed form as a control variate.
struct PolygonCvIntegrator {
  static constexpr const char* kName = "polygon_cv";
  static constexpr const char* kText =
      "direct light of polygon lights, with the closed form as control variate";
  std::optional<float> alpha = std::nullopt;  ///< of the control variate; none: fitted
  int vis_samples = 1;
  EmitterSampling emitter_sampling = EmitterSampling::kAuto;
  LightChoice light_choice = LightChoice::kAuto;
};

using IntegratorMethod =
    std::variant<DirectIntegrator, PathIntegrator, PolygonAnalyticIntegrator, PolygonAreaIntegrator,
                 PolygonCvIntegrator, WhittedIntegrator, AmbientOcclusionIntegrator,
                 ReflectionOcclusionIntegrator, VolpathIntegrator, NormalsIntegrator, PhotonMapIntegrator,
                 ProgressivePhotonIntegrator>;

struct IntegratorSettings {
  IntegratorMethod method = PathIntegrator{};
  bool hide_emitters = false;
  HiddenEmitters hidden_emitters = HiddenEmitters::kUnlit;  ///< only with hide_emitters

  template <typename Method>
  [[nodiscard]] bool is() const {
    return std::holds_alternative<Method>(method);
  }
  template <typename Method>
  [[nodiscard]] const Method* get() const {
    return std::get_if<Method>(&method);
  }
};

/// Selects a parameter by its member's name, in integrators that have such a member.
#define PENUMBRA_PARAMETER(member) \
  [](auto& owner_of_##member) -> decltype((owner_of_##member.member)) { return owner_of_##member.member; }

/// Calls use(parameter) if the integrator has the parameter, and returns whether it has. `Settings` may be
/// const.
template <typename Settings, typename Parameter, typename Use>
bool with_parameter(Settings& settings, const Parameter& parameter, const Use& use) {
  if constexpr (std::is_invocable_v<const Parameter&, Settings&>) {
    use(parameter(settings));
    return true;
  } else {
    // std::visit would make a table of functions, which takes several times as long to compile.
    const auto use_in = [&](auto* method) {
      if constexpr (std::is_invocable_v<const Parameter&, decltype(*method)>) {
        if (method != nullptr) use(parameter(*method));
        return method != nullptr;
      }
      return false;
    };
    return [&]<typename... Methods>(const std::variant<Methods...>&) {
      return (use_in(std::get_if<Methods>(&settings.method)) || ...);
    }(settings.method);
  }
}

/// The parameter's value, or `fallback` where the integrator has no such parameter.
template <typename Parameter, typename T>
T parameter_or(const IntegratorSettings& settings, const Parameter& parameter, T fallback) {
  with_parameter(settings, parameter, [&](const T& value) { fallback = value; });
  return fallback;
}

inline OneOf<EmitterSampling> emitter_samplings() {
  return {{{"auto", EmitterSampling::kAuto},
           {"area", EmitterSampling::kArea},
           {"solid_angle", EmitterSampling::kSolidAngle},
           {"projected", EmitterSampling::kProjected}}};
}

/// One parameter of integrators.
struct IntegratorParameter {
  const char* name;
  ValueFormat format;
  const char* description;
  /// Where it is stored; null if the integrator has no such parameter.
  void* (*find)(IntegratorSettings& integrator);
  /// Copies it to the kernels' parameters. Empty: it is no copy there.
  std::function<void(const void* from, IntegratorParameters& to)> copy = {};

  [[nodiscard]] const void* find_in(const IntegratorSettings& integrator) const {
    return find(const_cast<IntegratorSettings&>(integrator));  // it is only read from what is returned
  }
  [[nodiscard]] bool is_in(const IntegratorSettings& integrator) const {
    return find_in(integrator) != nullptr;
  }
};

/// All of them, in an order in which they may be set one after the other.
std::span<const IntegratorParameter> integrator_parameters();

/// Each integrator with its default values, under each of its names.
std::vector<std::pair<const char*, IntegratorMethod>> integrator_names();

/// One of each kind, with its default values.
std::vector<IntegratorMethod> integrator_methods();
/// The integrator's kind, "path" for example, whatever its parameters.
const char* method_name(const IntegratorMethod& method);

/// The most specific of its names, "path_ems" for example.
const char* integrator_name(const IntegratorSettings& integrator);

/// The direct sampling of `path`, `volpath` and the integrators with photons; nothing for other integrators.
std::optional<DirectSampling> direct_sampling(const IntegratorSettings& integrator);

/// Whether the integrator traces photons.
bool has_photons(const IntegratorSettings& integrator);

/// Whether the integrator sees participating media.
bool sees_media(const IntegratorSettings& integrator);

/// Whether the integrator sees the media inside of materials (interiors.h).
bool sees_interiors(const IntegratorSettings& integrator);

/// Changes to another integrator. Parameters that both have keep their values, except direct_sampling, which
/// the new name determines, alpha between those with photons and others, and the default of rr_depth.
void use_integrator(IntegratorSettings& integrator, IntegratorMethod method);

/// Parameters of the control variate: the closed form of polygon lights.
struct ControlVariate {
  std::optional<float> alpha;  ///< none: fitted
};
/// Nothing if the integrator uses no control variate.
std::optional<ControlVariate> control_variate(const IntegratorSettings& integrator);

}  // namespace penumbra
