// The parameters of integrators, and with them the integrators' part of the table of settings.
#include <fmt/format.h>

#include <algorithm>

#include "scenes/diagnostic.h"
#include "scenes/setting_rows.h"

namespace penumbra {
namespace {

/// How the values of a row are stored: enumerations as themselves.
template <typename Values>
struct Stored;
template <>
struct Stored<WholeNumber> : std::type_identity<int> {};
template <>
struct Stored<Number<float>> : std::type_identity<float> {};
template <>
struct Stored<NumberOrAuto> : std::type_identity<std::optional<float>> {};
template <>
struct Stored<TrueOrFalse> : std::type_identity<bool> {};
template <typename T>
struct Stored<OneOf<T>> : std::type_identity<T> {};

template <typename T, typename Parameter>
void* find_parameter(IntegratorSettings& integrator) {
  void* found = nullptr;
  with_parameter(integrator, Parameter{}, [&](T& value) { found = &value; });
  return found;
}

/// Makes the rows: row(name, parameter, values, text[, member of the kernels' parameters that is a copy]).
class RowMaker {
 public:
  explicit RowMaker(std::vector<IntegratorParameter>& rows) : rows_(rows) {}

  template <typename Parameter, typename Values, typename... Members>
  void operator()(const char* name, Parameter, const Values& values, const char* text,
                  Members... members) const {
    using T = Stored<Values>::type;
    rows_.push_back({name, format_of<T>(values), text, find_parameter<T, Parameter>});
    if constexpr (sizeof...(members) > 0)
      rows_.back().copy = [members...](const void* from, IntegratorParameters& to) {
        const T& value = *static_cast<const T*>(from);
        ((to.*members = std::remove_reference_t<decltype(to.*members)>(value)), ...);
      };
  }

 private:
  std::vector<IntegratorParameter>& rows_;
};

std::vector<IntegratorParameter> make_rows() {
  using P = IntegratorParameters;
  std::vector<IntegratorParameter> rows;
  const RowMaker row(rows);
  row("max_depth", PENUMBRA_PARAMETER(max_depth), WholeNumber{-1, kMaxInt},
      "longest path in edges (1: emitters seen directly, 2: direct light, -1: no limit)", &P::max_depth);
  row("rr_depth", PENUMBRA_PARAMETER(rr_depth), WholeNumber{1, kMaxInt},
      "Russian roulette from this depth on", &P::rr_depth);
  row("direct_sampling", PENUMBRA_PARAMETER(direct_sampling),
      OneOf<DirectSampling>{{{"mats", DirectSampling::kBsdfOnly},
                             {"ems", DirectSampling::kEmitterOnly},
                             {"mis", DirectSampling::kMis}}},
      "sampling strategies of direct light: BSDFs (mats), emitters (ems), or both (mis)",
      &P::direct_sampling);
  row("only_bounces", PENUMBRA_PARAMETER(only_bounces), WholeNumber{-1, kMaxInt - 1},
      "only light that this number of surfaces scattered (0: emitters seen directly, -1: all)",
      &P::only_bounces);
  row("only_technique", PENUMBRA_PARAMETER(only_technique),
      OneOf<PathTechnique>{{{"all", PathTechnique::kAll},
                            {"bsdf", PathTechnique::kBsdf},
                            {"emitter", PathTechnique::kEmitter}}},
      "only light of this sampling strategy, with its MIS weight", &P::only_technique);
  row("emitter_samples", PENUMBRA_PARAMETER(emitter_samples), WholeNumber{0, MAX_DIRECT_SAMPLES},
      "shadow rays per camera ray", &P::emitter_samples);
  row("bsdf_samples", PENUMBRA_PARAMETER(bsdf_samples), WholeNumber{0, MAX_DIRECT_SAMPLES},
      "sampled directions per camera ray", &P::bsdf_samples);
  row("bsdf_sampling", PENUMBRA_PARAMETER(bsdf_sampling),
      OneOf<BsdfSampling>{{{"bsdf", BsdfSampling::kBsdf},
                           {"cosine", BsdfSampling::kCosine},
                           {"uniform", BsdfSampling::kUniform}}},
      "density of the sampled directions", &P::bsdf_sampling);
  row("branch_depth", PENUMBRA_PARAMETER(branch_depth), WholeNumber{0, MAX_BRANCH_DEPTH},
      "surfaces, one after the other, at which paths branch; beyond them one branch is chosen at random",
      &P::branch_depth);
  row("indirect_samples", PENUMBRA_PARAMETER(indirect_samples), WholeNumber{0, MAX_DIRECT_SAMPLES},
      "directions sampled at each surface that is no mirror; 0: direct light alone there", &P::bsdf_samples);
  row("indirect_sampling", PENUMBRA_PARAMETER(indirect_sampling),
      OneOf<IndirectSampling>{{{"cosine", IndirectSampling::kCosine},
                               {"uniform", IndirectSampling::kUniform},
                               {"bsdf", IndirectSampling::kBsdf}}},
      "density of the directions of indirect_samples", &P::bsdf_sampling);
  row("emitter_sampling", PENUMBRA_PARAMETER(emitter_sampling), emitter_samplings(),
      "density of points on area lights; a light may say its own");
  row("mis", PENUMBRA_PARAMETER(heuristic),
      OneOf<MisHeuristic>{{{"balance", MisHeuristic::kBalance}, {"power", MisHeuristic::kPower}}},
      "MIS heuristic", &P::heuristic);
  row("light_choice", PENUMBRA_PARAMETER(light_choice),
      OneOf<LightChoice>{{{"auto", LightChoice::kAuto},
                          {"power", LightChoice::kPower},
                          {"analytic", LightChoice::kAnalytic},
                          {"tree", LightChoice::kTree}}},
      "light sampling; by power, by the unshadowed contribution of polygon lights, or by a tree with bounds "
      "of what each light may contribute");
  row("trace_shadows", PENUMBRA_PARAMETER(trace_shadows), TrueOrFalse{}, "whether shadow rays are traced",
      &P::trace_shadows);
  row("vis_samples", PENUMBRA_PARAMETER(vis_samples), WholeNumber{1, MAX_DIRECT_SAMPLES},
      "shadow rays per camera ray", &P::emitter_samples);
  row("occlusion_sampling", PENUMBRA_PARAMETER(sampling),
      OneOf<OcclusionSampling>{{{"cosine", OcclusionSampling::kCosine},
                                {"hemisphere", OcclusionSampling::kHemisphere},
                                {"sphere", OcclusionSampling::kSphere}}},
      "density of the directions of rays");
  row("occlusion_weighting", PENUMBRA_PARAMETER(weighting),
      OneOf<OcclusionWeighting>{
          {{"cosine", OcclusionWeighting::kCosine}, {"uniform", OcclusionWeighting::kUniform}}},
      "weight of directions: their cosine, or uniform", &P::weighting);
  row("exponent", PENUMBRA_PARAMETER(exponent), Number<float>{LowEnd::kClosed, 0.0f, 1e6f},
      "exponent of the Phong lobe", &P::exponent);
  row("ray_length", PENUMBRA_PARAMETER(ray_length), Number<float>{LowEnd::kClosed, -1.0f, 1e30f},
      "distance up to which surfaces occlude (0: no limit; negative: half the radius of the bounding sphere "
      "of all shapes)");
  row("background", PENUMBRA_PARAMETER(background), Number<float>{LowEnd::kClosed, 0.0f, 1e30f},
      "value where the camera sees no surface", &P::background);
  row("nee", PENUMBRA_PARAMETER(next_event),
      OneOf<NextEvent>{{{"sample", NextEvent::kSample}, {"cv", NextEvent::kCv}}},
      "next-event estimation; samples alone, or with the closed form of polygon lights as control variate");
  row("alpha", PENUMBRA_PARAMETER(alpha), NumberOrAuto{-1e6f, 1e6f},
      "weight of the control variate (auto: fitted for each pixel); ppm: how fast radii shrink, in (0, 1] "
      "(auto: 2/3)");
  row("photon_count", PENUMBRA_PARAMETER(photon_count), WholeNumber{1, MAX_PHOTONS},
      "photons emitted for each map", &P::surface_photons, &P::volume_photons);
  constexpr WholeNumber kPhotons{0, MAX_PHOTONS};
  row("global_photons", PENUMBRA_PARAMETER(global_photons), kPhotons, "photons emitted for the global map",
      &P::surface_photons);
  row("caustic_photons", PENUMBRA_PARAMETER(caustic_photons), kPhotons, "photons emitted for the caustic map",
      &P::caustic_photons);
  row("volume_photons", PENUMBRA_PARAMETER(volume_photons), kPhotons, "photons emitted for the map of media",
      &P::volume_photons);
  row("initial_radius", PENUMBRA_PARAMETER(initial_radius), Number<float>{LowEnd::kClosed, 0.0f, 1e30f},
      "radius of the first density estimates in scene units (0: from the size of a pixel)");
  row("photon_radius", PENUMBRA_PARAMETER(photon_radius), Number<float>{LowEnd::kClosed, 0.0f, 1e30f},
      "radius of all density estimates in scene units (0: by the lookup radii)");
  const Number<float> share{LowEnd::kOpen, 0.0f, 1.0f};
  row("global_lookup_radius", PENUMBRA_PARAMETER(global_lookup_radius), share,
      "radius of the global map's density estimates, in radii of the scene's bounding sphere");
  row("caustic_lookup_radius", PENUMBRA_PARAMETER(caustic_lookup_radius), share,
      "... of the caustic map's density estimates");
  row("volume_lookup_radius", PENUMBRA_PARAMETER(volume_lookup_radius), share,
      "... of the density estimates in media");
  row("lookup_size", PENUMBRA_PARAMETER(lookup_size), WholeNumber{1, MAX_PHOTONS},
      "photons of a density estimate: at most about so many, the nearest within the radius", &P::lookup_size);
  row("final_gather", PENUMBRA_PARAMETER(final_gather), TrueOrFalse{},
      "whether the global map is seen one diffuse bounce later, which hides its blotches", &P::gathering);
  row("caustics_only", PENUMBRA_PARAMETER(caustics_only), TrueOrFalse{},
      "whether photons bring caustics alone, and paths all other light");
  row("hide_emitters", PENUMBRA_PARAMETER(hide_emitters), TrueOrFalse{},
      "whether lights are invisible to the camera");
  row("hidden_emitters", PENUMBRA_PARAMETER(hidden_emitters),
      OneOf<HiddenEmitters>{
          {{"unlit", HiddenEmitters::kUnlit}, {"looked_through", HiddenEmitters::kLookedThrough}}},
      "what the camera sees of invisible lights: their unlit surface, or what is behind it");
  return rows;
}

/// `is_owner`: whether given integrator settings have the parameter.
std::unexpected<Error> not_a_parameter(const IntegratorSettings& integrator, const char* name,
                                       const std::function<bool(const IntegratorSettings&)>& is_owner) {
  std::vector<std::string> owners;
  for (const IntegratorMethod& method : integrator_methods())
    if (is_owner(IntegratorSettings{.method = method})) owners.emplace_back(method_name(method));
  return fail(fmt::format("integrator '{}' has no parameter '{}'; these have: {}",
                          method_name(integrator.method), name, list_names(owners)));
}

/// Whether every integrator has it.
bool is_in_all(const IntegratorParameter& parameter) {
  return std::ranges::all_of(integrator_methods(), [&](const IntegratorMethod& method) {
    return parameter.is_in(IntegratorSettings{.method = method});
  });
}

Setting parameter_row(const IntegratorParameter& parameter) {
  Setting setting =
      setting_of(fmt::format("integrator.{}", parameter.name), parameter.format, parameter.description);
  setting.apply = [&parameter](RenderSettings& settings, std::string_view text) -> Expected<void> {
    void* found = parameter.find(settings.integrator);
    if (const Expected<void> done = parameter.format.read(text, found); !done || found != nullptr)
      return done;
    return not_a_parameter(settings.integrator, parameter.name,
                           [&](const IntegratorSettings& other) { return parameter.is_in(other); });
  };
  setting.print = [&parameter](const RenderSettings& settings) {
    const void* found = parameter.find_in(settings.integrator);
    return found != nullptr ? parameter.format.print(found) : "";
  };
  if (!is_in_all(parameter))
    setting.is_there = [&parameter](const RenderSettings& settings) {
      return parameter.is_in(settings.integrator);
    };
  setting.recorded = true;
  return setting;
}

Setting type_row() {
  std::vector<std::string> names;
  for (const auto& [name, method] : integrator_names()) names.emplace_back(name);
  Setting setting{
      .key = "integrator.type",
      .kind = SettingKind::kText,
      .values = list_names(names),
      .description = "integrator; path is path_mis; parameters that the one before has as well are kept",
      .choices = names,
      .option = "integrator",
      .recorded = true};
  setting.apply = [names](RenderSettings& settings, std::string_view text) -> Expected<void> {
    const auto index = parse_name(text, names);
    if (!index) return std::unexpected(index.error());
    use_integrator(settings.integrator, integrator_names()[*index].second);
    return {};
  };
  setting.print = [](const RenderSettings& settings) {
    return std::string(integrator_name(settings.integrator));
  };
  return setting;
}

/// Mitsuba's single name for both numbers of samples, and for those of its ambient occlusion.
Setting shading_samples_row() {
  const WholeNumber values{1, MAX_DIRECT_SAMPLES};
  Setting setting = setting_of("integrator.shading_samples", format_of<int>(values),
                               "emitter_samples and bsdf_samples at once; vis_samples of ao");
  const auto is_owner = [](const IntegratorSettings& integrator) {
    return integrator.is<DirectIntegrator>() || integrator.is<AmbientOcclusionIntegrator>();
  };
  setting.is_there = [=](const RenderSettings& settings) { return is_owner(settings.integrator); };
  setting.apply = [=](RenderSettings& settings, std::string_view text) -> Expected<void> {
    const auto value = values.parse(text);
    if (!value) return std::unexpected(value.error());
    if (auto* ambient = std::get_if<AmbientOcclusionIntegrator>(&settings.integrator.method)) {
      ambient->vis_samples = int(*value);
      return {};
    }
    auto* direct = std::get_if<DirectIntegrator>(&settings.integrator.method);
    if (direct == nullptr) return not_a_parameter(settings.integrator, "shading_samples", is_owner);
    direct->emitter_samples = direct->bsdf_samples = int(*value);
    return {};
  };
  return setting;
}

/// Marks settings that have an effect only with certain values of others.
void set_dependencies(std::vector<Setting>& table) {
  for (Setting& setting : table) {
    if (setting.key == "integrator.alpha")
      setting.matters = [](const RenderSettings& s) {
        return control_variate(s.integrator) || s.integrator.is<ProgressivePhotonIntegrator>();
      };
    if (setting.key == "integrator.hidden_emitters")
      setting.matters = [](const RenderSettings& s) { return s.integrator.hide_emitters; };
  }
}

}  // namespace

std::span<const IntegratorParameter> integrator_parameters() {
  static const std::vector<IntegratorParameter> rows = make_rows();
  return rows;
}

void add_integrator_rows(std::vector<Setting>& table) {
  table.push_back(type_row());
  table.push_back(shading_samples_row());
  for (const IntegratorParameter& parameter : integrator_parameters())
    table.push_back(parameter_row(parameter));
  set_dependencies(table);
}

}  // namespace penumbra
