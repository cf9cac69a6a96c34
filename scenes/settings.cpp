#include "scenes/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/diagnostic.h"
#include "scenes/names.h"
#include "scenes/number.h"
#include "scenes/transform.h"

namespace penumbra {
namespace {

constexpr int kMaxFilmSide = 65536;
constexpr std::int64_t kMaxFilmPixels = std::int64_t{1} << 31;
constexpr double kMaxAlpha = 1e6;
constexpr std::int64_t kMaxInt = std::numeric_limits<int>::max();

template <typename Store>
Setting integer(std::string key, std::int64_t low, std::int64_t high, Store store) {
  return {std::move(key), SettingKind::kInteger,
          [=](SceneDescription& scene, std::string_view text) -> Expected<void> {
            const auto value = parse_integer(text, low, high);
            if (!value) return std::unexpected(value.error());
            store(scene, *value);
            return {};
          }};
}

/// A number with low < value < high, or low <= value < high.
enum class LowEnd { kOpen, kClosed };
template <typename Store>
Setting number(std::string key, LowEnd end, double low, double high, Store store) {
  return {std::move(key), SettingKind::kNumber,
          [=](SceneDescription& scene, std::string_view text) -> Expected<void> {
            const auto value = parse_number(text);
            if (!value) return std::unexpected(value.error());
            if (!(end == LowEnd::kOpen ? *value > low : *value >= low) || !(*value < high)) {
              return fail(fmt::format("{} is not {} {} and below {}", *value,
                                      end == LowEnd::kOpen ? "above" : "at least", low, high));
            }
            store(scene, *value);
            return {};
          }};
}

/// A number in [low, high], or "auto", for which there is none.
template <typename Store>
Setting number_or_auto(std::string key, double low, double high, Store store) {
  return {std::move(key), SettingKind::kNumberOrText,
          [=](SceneDescription& scene, std::string_view text) -> Expected<void> {
            if (trim(text) == "auto") {
              store(scene, std::nullopt);
              return {};
            }
            const auto value = parse_number(text);
            if (!value) return fail(value.error().message + "; nor is it 'auto'");
            if (!(*value >= low && *value <= high))
              return fail(fmt::format("{} is not between {} and {}", *value, low, high));
            store(scene, *value);
            return {};
          }};
}

template <typename Store>
Setting boolean(std::string key, Store store) {
  return {std::move(key), SettingKind::kBoolean,
          [=](SceneDescription& scene, std::string_view text) -> Expected<void> {
            const auto value = parse_boolean(text);
            if (!value) return std::unexpected(value.error());
            store(scene, *value);
            return {};
          }};
}

std::string unknown_name(std::string_view name, const std::vector<std::string>& known) {
  return fmt::format("'{}' is not one of: {}{}", name, list_names(known), suggestion(name, known));
}

struct Choice {
  std::string name;
  std::function<void(SceneDescription&)> choose;
};

Setting choice(std::string key, std::vector<Choice> choices) {
  std::vector<std::string> names;
  for (const Choice& each : choices) names.push_back(each.name);
  return {std::move(key), SettingKind::kText,
          [choices = std::move(choices), names](SceneDescription& scene,
                                                std::string_view text) -> Expected<void> {
            const std::string_view name = trim(text);
            const auto found = std::ranges::find(choices, name, &Choice::name);
            if (found == choices.end()) return fail(unknown_name(name, names));
            found->choose(scene);
            return {};
          },
          names};
}

template <typename Store>
Setting frame(std::string key, std::size_t count, Store make) {
  return {std::move(key), SettingKind::kText,
          [=](SceneDescription& scene, std::string_view text) -> Expected<void> {
            const auto numbers = parse_numbers(text);
            if (!numbers) return std::unexpected(numbers.error());
            if (numbers->size() != count)
              return fail(fmt::format("it takes {} numbers, not {}", count, numbers->size()));
            const Expected<glm::dmat4> matrix = make(*numbers);
            if (!matrix) return std::unexpected(matrix.error());
            if (is_singular(*matrix)) return fail("the matrix is singular");
            const auto rigid = without_scale(*matrix);
            if (!rigid) return std::unexpected(rigid.error());
            scene.camera.to_world = *rigid;
            return {};
          }};
}

void use_integrator(SceneDescription& scene, IntegratorKind kind, DirectSampling sampling) {
  scene.integrator.kind = kind;
  scene.integrator.direct_sampling = sampling;
}

void use_filter(SceneDescription& scene, FilterKind kind, float radius) {
  scene.film.filter = kind;
  scene.film.filter_radius = radius;
}

/// A crop window that was the whole film stays the whole film.
void resize(int& size, int& crop_offset, int& crop_size, int new_size) {
  if (crop_offset == 0 && crop_size == size) crop_size = new_size;
  size = new_size;
}

void add_integrator_settings(std::vector<Setting>& table) {
  using S = SceneDescription;
  using enum IntegratorKind;
  using enum DirectSampling;
  table.push_back(choice("integrator.type",
                         {{"direct", [](S& s) { use_integrator(s, kDirect, kMis); }},
                          {"path", [](S& s) { use_integrator(s, kPath, kMis); }},
                          {"path_mats", [](S& s) { use_integrator(s, kPath, kBsdfOnly); }},
                          {"path_ems", [](S& s) { use_integrator(s, kPath, kEmitterOnly); }},
                          {"path_mis", [](S& s) { use_integrator(s, kPath, kMis); }},
                          {"polygon_analytic", [](S& s) { use_integrator(s, kPolygonAnalytic, kMis); }},
                          {"polygon_area", [](S& s) { use_integrator(s, kPolygonArea, kMis); }},
                          {"polygon_cv", [](S& s) { use_integrator(s, kPolygonCv, kMis); }}}));
  table.push_back(integer("integrator.max_depth", -1, kMaxInt,
                          [](S& s, std::int64_t v) { s.integrator.max_depth = int(v); }));
  table.push_back(integer("integrator.rr_depth", 1, kMaxInt,
                          [](S& s, std::int64_t v) { s.integrator.rr_depth = int(v); }));
  table.push_back(choice("integrator.direct_sampling",
                         {{"mats", [](S& s) { s.integrator.direct_sampling = kBsdfOnly; }},
                          {"ems", [](S& s) { s.integrator.direct_sampling = kEmitterOnly; }},
                          {"mis", [](S& s) { s.integrator.direct_sampling = kMis; }}}));
  table.push_back(integer("integrator.shading_samples", 1, MAX_DIRECT_SAMPLES, [](S& s, std::int64_t v) {
    s.integrator.emitter_samples = s.integrator.bsdf_samples = int(v);
  }));
  table.push_back(integer("integrator.emitter_samples", 0, MAX_DIRECT_SAMPLES,
                          [](S& s, std::int64_t v) { s.integrator.emitter_samples = int(v); }));
  table.push_back(integer("integrator.bsdf_samples", 0, MAX_DIRECT_SAMPLES,
                          [](S& s, std::int64_t v) { s.integrator.bsdf_samples = int(v); }));
  table.push_back(choice("integrator.bsdf_sampling",
                         {{"bsdf", [](S& s) { s.integrator.bsdf_sampling = BsdfSampling::kBsdf; }},
                          {"cosine", [](S& s) { s.integrator.bsdf_sampling = BsdfSampling::kCosine; }},
                          {"uniform", [](S& s) { s.integrator.bsdf_sampling = BsdfSampling::kUniform; }}}));
  table.push_back({"integrator.emitter_sampling", SettingKind::kText,
                   [](S& scene, std::string_view text) -> Expected<void> {
                     const auto sampling = emitter_sampling_from_name(trim(text));
                     if (!sampling) return std::unexpected(sampling.error());
                     scene.integrator.emitter_sampling = *sampling;
                     return {};
                   }});
  table.push_back(
      choice("integrator.mis", {{"balance", [](S& s) { s.integrator.heuristic = MisHeuristic::kBalance; }},
                                {"power", [](S& s) { s.integrator.heuristic = MisHeuristic::kPower; }}}));
  table.push_back(choice("integrator.light_choice",
                         {{"auto", [](S& s) { s.integrator.light_choice = LightChoice::kAuto; }},
                          {"power", [](S& s) { s.integrator.light_choice = LightChoice::kPower; }},
                          {"analytic", [](S& s) { s.integrator.light_choice = LightChoice::kAnalytic; }}}));
  table.push_back(boolean("integrator.trace_shadows", [](S& s, bool v) { s.integrator.trace_shadows = v; }));
  table.push_back(integer("integrator.vis_samples", 1, MAX_DIRECT_SAMPLES,
                          [](S& s, std::int64_t v) { s.integrator.vis_samples = int(v); }));
  table.push_back(number_or_auto("integrator.alpha", -kMaxAlpha, kMaxAlpha,
                                 [](S& s, std::optional<double> v) { s.integrator.alpha = v; }));
  table.push_back(choice("integrator.estimator",
                         {{"cv", [](S& s) { s.integrator.estimator = CvEstimator::kCv; }},
                          {"ratio", [](S& s) { s.integrator.estimator = CvEstimator::kRatio; }}}));
  table.push_back(
      choice("integrator.nee", {{"sample", [](S& s) { s.integrator.next_event = NextEvent::kSample; }},
                                {"cv", [](S& s) { s.integrator.next_event = NextEvent::kCv; }}}));
  table.push_back(boolean("integrator.hide_emitters", [](S& s, bool v) { s.integrator.hide_emitters = v; }));
  table.push_back(choice(
      "integrator.hidden_emitters",
      {{"unlit", [](S& s) { s.integrator.hidden_emitters = HiddenEmitters::kUnlit; }},
       {"looked_through", [](S& s) { s.integrator.hidden_emitters = HiddenEmitters::kLookedThrough; }}}));
}

void add_sampler_settings(std::vector<Setting>& table) {
  using S = SceneDescription;
  using enum SamplerKind;
  table.push_back(choice("sampler.type", {{"independent", [](S& s) { s.sampler.kind = kIndependent; }},
                                          {"stratified", [](S& s) { s.sampler.kind = kStratified; }},
                                          {"halton", [](S& s) { s.sampler.kind = kHalton; }},
                                          {"sobol", [](S& s) { s.sampler.kind = kSobol; }}}));
  table.push_back(integer("sampler.sample_count", 1, kMaxSamplesPerPixel,
                          [](S& s, std::int64_t v) { s.sampler.spp = std::uint32_t(v); }));
  table.push_back(
      integer("sampler.seed", 0, kMaxSeed, [](S& s, std::int64_t v) { s.sampler.seed = std::uint32_t(v); }));
}

void add_film_settings(std::vector<Setting>& table) {
  using S = SceneDescription;
  using enum FilterKind;
  table.push_back(integer("film.width", 1, kMaxFilmSide, [](S& s, std::int64_t v) {
    resize(s.film.width, s.film.crop_x, s.film.crop_width, int(v));
  }));
  table.push_back(integer("film.height", 1, kMaxFilmSide, [](S& s, std::int64_t v) {
    resize(s.film.height, s.film.crop_y, s.film.crop_height, int(v));
  }));
  table.push_back(
      integer("film.crop_offset_x", 0, kMaxFilmSide, [](S& s, std::int64_t v) { s.film.crop_x = int(v); }));
  table.push_back(
      integer("film.crop_offset_y", 0, kMaxFilmSide, [](S& s, std::int64_t v) { s.film.crop_y = int(v); }));
  table.push_back(
      integer("film.crop_width", 1, kMaxFilmSide, [](S& s, std::int64_t v) { s.film.crop_width = int(v); }));
  table.push_back(integer("film.crop_height", 1, kMaxFilmSide,
                          [](S& s, std::int64_t v) { s.film.crop_height = int(v); }));
  table.push_back(choice("film.rfilter",
                         {{"box", [](S& s) { use_filter(s, kBox, 0.5f); }},
                          {"tent", [](S& s) { use_filter(s, kTent, 1.0f); }},
                          {"gaussian", [](S& s) { use_filter(s, kGaussian, 4.0f * s.film.filter_stddev); }},
                          {"mitchell", [](S& s) { use_filter(s, kMitchell, 2.0f); }}}));
  // Half a film's width is far beyond any use; it keeps radii away from overflow.
  constexpr double kMaxRadius = 1024.0;
  // Far less than a pixel, and its square is still a float.
  constexpr double kMinRadius = 1e-4;
  table.push_back(number("film.rfilter_radius", LowEnd::kClosed, kMinRadius, kMaxRadius,
                         [](S& s, double v) { s.film.filter_radius = float(v); }));
  table.push_back(number("film.rfilter_stddev", LowEnd::kClosed, kMinRadius, kMaxRadius, [](S& s, double v) {
    s.film.filter_stddev = float(v);
    if (s.film.filter == kGaussian) s.film.filter_radius = 4.0f * float(v);
  }));
  table.push_back(number("film.rfilter_b", LowEnd::kClosed, -10.0, 10.0,
                         [](S& s, double v) { s.film.filter_b = float(v); }));
  table.push_back(number("film.rfilter_c", LowEnd::kClosed, -10.0, 10.0,
                         [](S& s, double v) { s.film.filter_c = float(v); }));
}

void add_camera_settings(std::vector<Setting>& table) {
  using S = SceneDescription;
  using enum FovAxis;
  constexpr double kFar = std::numeric_limits<float>::max();
  table.push_back(number("camera.fov", LowEnd::kOpen, 0.0, 180.0, [](S& s, double v) { s.camera.fov = v; }));
  table.push_back(choice("camera.fov_axis", {{"x", [](S& s) { s.camera.fov_axis = kX; }},
                                             {"y", [](S& s) { s.camera.fov_axis = kY; }},
                                             {"diagonal", [](S& s) { s.camera.fov_axis = kDiagonal; }},
                                             {"smaller", [](S& s) { s.camera.fov_axis = kSmaller; }},
                                             {"larger", [](S& s) { s.camera.fov_axis = kLarger; }}}));
  table.push_back(
      number("camera.near_clip", LowEnd::kOpen, 0.0, kFar, [](S& s, double v) { s.camera.near_clip = v; }));
  table.push_back(
      number("camera.far_clip", LowEnd::kOpen, 0.0, kFar, [](S& s, double v) { s.camera.far_clip = v; }));
  table.push_back(
      frame("camera.to_world", 16, [](const std::vector<double>& v) { return matrix_from_rows(v); }));
  table.push_back(frame("camera.lookat", 9, [](const std::vector<double>& v) {
    return look_at({v[0], v[1], v[2]}, {v[3], v[4], v[5]}, glm::dvec3(v[6], v[7], v[8]));
  }));
}

std::vector<Setting> make_table() {
  std::vector<Setting> table;
  add_integrator_settings(table);
  add_sampler_settings(table);
  add_film_settings(table);
  add_camera_settings(table);
  return table;
}

constexpr std::pair<std::string_view, EmitterSampling> kEmitterSamplings[] = {
    {"auto", EmitterSampling::kAuto},
    {"area", EmitterSampling::kArea},
    {"solid_angle", EmitterSampling::kSolidAngle},
    {"projected", EmitterSampling::kProjected}};

}  // namespace

Expected<EmitterSampling> emitter_sampling_from_name(std::string_view name) {
  std::vector<std::string> names;
  for (const auto& [known, sampling] : kEmitterSamplings) {
    if (known == name) return sampling;
    names.emplace_back(known);
  }
  return fail(unknown_name(name, names));
}

std::string_view emitter_sampling_name(EmitterSampling sampling) {
  return kEmitterSamplings[std::size_t(sampling)].first;
}

std::span<const Setting> all_settings() {
  static const std::vector<Setting> table = make_table();
  return table;
}

const Setting* find_setting(std::string_view key) {
  const auto settings = all_settings();
  const auto found =
      std::find_if(settings.begin(), settings.end(), [&](const Setting& s) { return s.key == key; });
  return found == settings.end() ? nullptr : &*found;
}

Expected<void> apply_setting(SceneDescription& scene, std::string_view key, std::string_view value) {
  const Setting* setting = find_setting(to_snake_case(key));
  if (setting == nullptr) {
    std::vector<std::string> known;
    for (const Setting& each : all_settings()) known.push_back(each.key);
    return fail(fmt::format(
        "there is no setting '{}'{} The settings are: {}", key,
        suggestion(to_snake_case(key), known).empty() ? ";" : suggestion(to_snake_case(key), known),
        list_names(known)));
  }
  if (const auto done = setting->apply(scene, value); !done) {
    return fail(fmt::format("setting {}: {}", setting->key, done.error().message));
  }
  return {};
}

Expected<void> check_settings(const SceneDescription& scene) {
  const Film& film = scene.film;
  const bool inside = film.crop_x >= 0 && film.crop_y >= 0 && film.crop_width >= 1 && film.crop_height >= 1 &&
                      std::int64_t{film.crop_x} + film.crop_width <= film.width &&
                      std::int64_t{film.crop_y} + film.crop_height <= film.height;
  if (!inside) {
    return fail(fmt::format("the crop window of {} x {} pixels at ({}, {}) is not inside the film of {} x {}",
                            film.crop_width, film.crop_height, film.crop_x, film.crop_y, film.width,
                            film.height));
  }
  if (std::int64_t{film.crop_width} * film.crop_height > kMaxFilmPixels) {
    return fail(fmt::format("an image of {} x {} pixels is too large: at most {} pixels, {} a side",
                            film.crop_width, film.crop_height, kMaxFilmPixels, kMaxFilmSide));
  }
  if (!(scene.camera.near_clip < scene.camera.far_clip)) {
    return fail(fmt::format("the camera's near_clip, {}, must be less than its far_clip, {}",
                            scene.camera.near_clip, scene.camera.far_clip));
  }
  if (scene.integrator.kind == IntegratorKind::kDirect && scene.integrator.emitter_samples == 0 &&
      scene.integrator.bsdf_samples == 0) {
    return fail("integrator 'direct' needs at least one of emitter_samples and bsdf_samples");
  }
  if (scene.integrator.kind == IntegratorKind::kPolygonArea && scene.integrator.emitter_samples == 0)
    return fail("integrator 'polygon_area' needs emitter_samples");
  if (scene.integrator.kind == IntegratorKind::kPath && scene.integrator.next_event == NextEvent::kCv &&
      scene.integrator.direct_sampling == DirectSampling::kBsdfOnly)
    return fail("integrator 'path' with nee = cv samples emitters, which direct_sampling = mats forbids");
  return {};
}

}  // namespace penumbra
