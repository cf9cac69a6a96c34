#include "scenes/mitsuba/medium_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

namespace penumbra::mitsuba {
namespace {

template <typename Result>
struct Kind {
  std::string_view type;
  Result (*read)(PluginReader&);
};
template <typename Result, typename Model>
Result read_as(PluginReader& plugin) {
  Model model;
  plugin.read_parameters(model);
  if constexpr (std::is_same_v<Result, PhaseLobe>)
    return model.lobe();
  else
    return model.medium();
}
template <typename Result, typename... Models>
constexpr auto kinds(const std::variant<Models...>*) {
  return std::array{Kind<Result>{Models::kPlugin, read_as<Result, Models>}...};
}
constexpr auto kPhases = kinds<PhaseLobe>(static_cast<const PhasePlugins*>(nullptr));
constexpr auto kMedia = kinds<ParticipatingMedium>(static_cast<const MediumKinds*>(nullptr));

constexpr std::size_t kMostLevels = 8;  // each level may read two phase functions

/// Adds lobes with their share of a mixture. Equal lobes are merged.
void mix(std::vector<PhaseLobe>& mixture, const std::vector<PhaseLobe>& lobes, float share) {
  for (PhaseLobe lobe : lobes) {
    lobe.weight *= share;
    if (!(lobe.weight > 0.0f)) continue;
    const auto same = std::ranges::find_if(
        mixture, [&](const PhaseLobe& other) { return other.kind == lobe.kind && other.g == lobe.g; });
    if (same != mixture.end())
      same->weight += lobe.weight;
    else
      mixture.push_back(lobe);
  }
}

/// The rest of a heterogeneous medium of Mitsuba 0.x: parameters of its way to sample, and a density that no
/// grid bounds.
void finish_old(const Context& context, PluginReader& plugin, ParticipatingMedium& medium) {
  plugin.accept({"method", "step_size"});
  for (const auto& [name, volume] : plugin.named("volume")) {
    if (name == "orientation")
      context.unsupported(volume->location, "a medium of fibres, with an orientation, is not read",
                          "it scatters the same in all directions");
    else if (name != "sigma_t" && name != "albedo" && name != "emission")
      context.unsupported(
          volume->location,
          fmt::format("a volume named '{}'; those of a medium are named density and albedo", name),
          "it is ignored");
  }
  // Mitsuba asks for both; lajolla (media/heterogeneous.cpp) takes 1.
  const auto is_given = [&](std::string_view name) { return plugin.has(name) || plugin.has_nested(name); };
  if (!is_given("sigma_t")) plugin.warn("the medium has no volume named density: it counts as 1 everywhere");
  if (!is_given("albedo")) medium.albedo = glm::vec3(1.0f);
  if (medium.density && medium.density->grid->values.size() == 1) medium.density.reset();
}

}  // namespace

void MediumReader::read(const Object& medium) {
  if (media_.contains(&medium)) return;
  if (context_.media_seen) {
    media_[&medium].medium = read_new(context_, medium);
    return;
  }
  Diagnostics unseen;
  Context context{context_.tree, unseen};
  context.textures = context_.textures;
  context.files = context_.files;
  context.volumes = context_.volumes;
  std::optional<ParticipatingMedium> read = read_new(context, medium);
  if (!unseen.failed()) media_[&medium].medium = std::move(read);
  media_[&medium];
  context_.diagnostics.warn(medium.type_location,
                            "the scene's integrator passes through media as if they were not there; volpath "
                            "follows light through them");
}

int MediumReader::install(const Object& medium, SceneDescription& scene) {
  read(medium);
  Entry& entry = media_[&medium];
  if (entry.medium && entry.index == kNoMedium) {
    entry.index = int(scene.media.size());
    scene.media.push_back(*entry.medium);
  }
  return entry.index;
}

void MediumReader::install(PluginReader& plugin, Shape& shape, SceneDescription& scene) {
  std::set<std::string> names;
  for (const auto& [name, medium] : plugin.named("medium")) {
    const int index = install(*medium, scene);
    if (name == "interior")
      shape.interior = index;
    else if (name == "exterior")
      shape.exterior = index;
    else
      plugin.warn("a medium has no effect unless it is named 'interior' or 'exterior'");
    if (!names.insert(name).second) plugin.wrong(fmt::format("two media are named '{}'", name));
  }
}

std::optional<ParticipatingMedium> MediumReader::read_new(const Context& context, const Object& medium) {
  const bool is_old = medium.type == HeterogeneousMedium::kPlugin && context.tree.major_version < 2;
  const Object in_new_words = is_old ? renamed(medium, {{"density", "sigma_t"}}) : Object{};
  PluginReader plugin(context, is_old ? in_new_words : medium);
  const Kind<ParticipatingMedium>* kind = find_plugin(kMedia, medium.type);
  if (kind == nullptr) {
    context.unknown_plugin(medium, plugin_types(kMedia), "it is left out");
    plugin.skip();
    return std::nullopt;
  }
  ParticipatingMedium result = kind->read(plugin);
  if (is_old) finish_old(context, plugin, result);
  // Parameters of sampling methods that are not used here.
  plugin.accept({"sample_emitters", "has_spectral_extinction", "strategy", "sampling_weight",
                 "medium_sampling_mode", "majorant_resolution_factor", "majorant_factor"});
  const Object* phase = plugin.only_nested("phase");
  plugin.finish();
  std::optional<Lobes> lobes =
      phase != nullptr ? read_phase(context, *phase) : std::optional(Lobes{IsotropicPhase{}.lobe()});
  if (!lobes) return std::nullopt;
  result.name = name_of(medium);
  result.phase = std::move(*lobes);
  return result;
}

std::optional<MediumReader::Lobes> MediumReader::read_phase(const Context& context, const Object& phase) {
  PluginReader plugin(context, phase);
  std::optional<Lobes> lobes;
  if (phase.type == BlendPhase::kPlugin) {
    lobes = read_blend(context, plugin);
  } else if (const Kind<PhaseLobe>* known = find_plugin(kPhases, phase.type)) {
    lobes = Lobes{known->read(plugin)};
  } else {
    std::vector<std::string> types = plugin_types(kPhases);
    types.emplace_back(BlendPhase::kPlugin);
    context.unknown_plugin(phase, types, "isotropic stands in for it");
    if (context.lenient) lobes = Lobes{IsotropicPhase{}.lobe()};
    plugin.skip();
  }
  plugin.finish();
  return lobes;
}

std::optional<MediumReader::Lobes> MediumReader::read_blend(const Context& context, PluginReader& plugin) {
  BlendPhase blend;
  plugin.read_parameters(blend);
  const std::vector<const Object*> inside = plugin.nested("phase");
  if (inside.size() != 2) {
    plugin.wrong(fmt::format("blendphase holds 2 phase functions, not {}", inside.size()));
    return std::nullopt;
  }
  if (!reading_.insert(&plugin.object()).second) {
    plugin.wrong("the phase function holds itself");
    return std::nullopt;
  }
  if (reading_.size() > kMostLevels) {
    plugin.wrong(fmt::format("phase functions within phase functions of more than {} levels", kMostLevels));
    reading_.erase(&plugin.object());
    return std::nullopt;
  }
  const std::optional<Lobes> first = read_phase(context, *inside[0]),
                             second = read_phase(context, *inside[1]);
  reading_.erase(&plugin.object());
  if (!first || !second) return std::nullopt;
  Lobes mixture;
  mix(mixture, *first, 1.0f - blend.weight.x);
  mix(mixture, *second, blend.weight.x);
  if (mixture.size() <= PHASE_LOBES) return mixture;
  plugin.wrong(fmt::format("a mixture of {} phase functions that differ; there may be {}", mixture.size(),
                           PHASE_LOBES));
  return std::nullopt;
}

}  // namespace penumbra::mitsuba
