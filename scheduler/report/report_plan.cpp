#include "scheduler/report/report_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <xxhash.h>

#include <algorithm>

#include "scenes/names.h"
#include "scenes/settings.h"
#include "scheduler/record/version.h"
#include "scheduler/report/reference_choice.h"
#include "scheduler/run/render_preparation.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

/// Whether the integrator has the parameter of "key=value". Unknown keys return true and are reported by the
/// reader.
bool has_setting(const std::string& integrator, const std::string& assignment) {
  RenderSettings settings;
  if (!apply_setting(settings, "integrator.type", integrator)) return true;
  const Setting* setting = find_setting(to_snake_case(assignment.substr(0, assignment.find('='))));
  return setting == nullptr || setting->belongs_to(settings);
}

/// The options of all cells of this scene with this method.
RenderOptions cell_options(const ReportOptions& report, const std::string& scene, const Method& method,
                           const std::string& sampler, const std::string& backend, std::uint32_t spp) {
  RenderOptions options = report.render;
  options.scene.file = scene;
  options.scene.no_features = true;  // other renderers do not compute these layers either
  if (!method.integrator.empty()) {
    options.scene.integrator = method.integrator;
    // Settings for all methods apply only to those that have such a parameter.
    std::erase_if(options.scene.settings,
                  [&](const std::string& text) { return !has_setting(method.integrator, text); });
  }
  options.scene.settings.insert(options.scene.settings.end(), method.settings.begin(), method.settings.end());
  if (!sampler.empty()) options.scene.sampler = sampler;
  options.scene.spp = spp;
  options.scene.seed = 0;
  options.backend = backend_from_name(backend);
  const BackendsInUse in_use = backends_in_use(backend);
  if (!in_use.opencl) options.opencl_device.clear();
  if (!in_use.native) options.isa.clear();
  options.no_statistics = true;
  return options;
}

/// Error if a common setting belongs to no method.
Expected<void> check_common_settings(const ReportOptions& report) {
  for (const std::string& text : report.render.scene.settings) {
    const auto has = [&](const Method& m) { return m.integrator.empty() || has_setting(m.integrator, text); };
    if (report.methods.empty() || std::ranges::any_of(report.methods, has)) continue;
    return fail(fmt::format("--set {}: no method of this report has such a parameter", text));
  }
  return {};
}

bool sees_media(const RenderJob& job) { return (job.scene.header.features & FEATURE_MEDIA) != 0u; }

/// A scene with the settings of a method, and the data from which its cells' hashes are computed.
struct MethodScene {
  PreparedRender prepared;
  std::string device_hash;
};

Expected<MethodScene> prepare_method(const RenderOptions& options, const std::string& label,
                                     const CellStore& store) {
  RenderOptions unnamed = options;
  unnamed.out = store.image_path({"cell", "0"}).string();
  auto prepared = prepare_render(unnamed);
  if (!prepared)
    return fail(
        fmt::format("{}\n(scene {}, method '{}')", prepared.error().message, options.scene.file, label));
  std::string hash = prepared->job.manifest->hash;
  return MethodScene{std::move(*prepared), std::move(hash)};
}

Json cell_settings(const ReportOptions& report, const MethodScene& method, std::uint32_t spp,
                   std::uint32_t seed, const std::string& worker_hash) {
  const RenderJob& job = method.prepared.job;
  const bool native = job.device.backend == Backend::kNative;
  return {{"scene", method.prepared.record.scene.file},
          {"device_scene", method.device_hash},
          {"window", {job.x, job.y, job.width, job.height}},
          {"spp", spp},
          {"seed", seed},
          {"samples_per_pass", job.request.plan.samples_per_pass},
          {"tile", job.request.plan.tile},
          {"workers", method.prepared.farm.workers},
          {"threads", job.device.threads},
          {"backend", native ? "native" : "opencl"},
          {"isa", native ? std::string(isa_name(job.device.isa)) : ""},
          {"opencl_device", job.device.opencl_device},
          {"repeats", report.repeats},
          {"penumbra", kVersion},
          {"worker", worker_hash}};
}

CellPlan make_cell(const ReportOptions& report, const MethodScene& method, RenderOptions options,
                   const std::string& label, std::uint32_t seed, const CellStore& store,
                   const std::string& worker_hash) {
  CellPlan cell;
  const std::uint32_t spp = *options.scene.spp;
  cell.settings = cell_settings(report, method, spp, seed, worker_hash);
  cell.id = make_cell_id(fmt::format("{}.{}spp.{:08x}", label, spp, seed), cell.settings);
  cell.what = fmt::format("{}, {} spp, seed {}", label, spp, seed);
  options.scene.seed = seed;
  options.out = store.image_path(cell.id).string();
  cell.options = std::move(options);
  return cell;
}

/// What the curves of a scene share.
struct SceneContext {
  const ReportOptions& options;
  const CellStore& store;
  const std::string& worker_hash;
  std::string file, name;
  std::uint32_t base_seed = 0;
};

/// The method's label, with sampler and backend if there are several of these.
std::string curve_label(const ReportOptions& options, const Method& method, const std::string& sampler,
                        const std::string& backend) {
  std::string label = method.label;
  if (options.samplers.size() > 1) label += ", " + sampler;
  if (options.backends.size() > 1) label += ", " + backend;
  return label;
}

Expected<CurvePlan> plan_curve(const SceneContext& context, const Method& method, const std::string& sampler,
                               const std::string& backend, PixelWindow& window,
                               std::optional<ReferencePair>& reference) {
  const ReportOptions& options = context.options;
  CurvePlan curve;
  curve.budgets = options.budgets;
  std::optional<MethodScene> scene;
  for (const std::uint32_t spp : options.budgets) {
    const RenderOptions cell = cell_options(options, context.file, method, sampler, backend, spp);
    // The device scene depends on the number of samples only for stratified sampling.
    if (!scene || scene->prepared.record.sampler.kind == SamplerKind::kStratified) {
      auto prepared = prepare_method(cell, method.label, context.store);
      if (!prepared) return std::unexpected(prepared.error());
      scene = std::move(*prepared);
    }
    const RenderJob& job = scene->prepared.job;
    const RenderRecord& record = scene->prepared.record;
    window = {job.x, job.y, job.width, job.height};
    const bool has_media = sees_media(job);
    if (!reference) reference = choose_reference(record.integrator, has_media);
    if (curve.cells.empty()) {
      curve.name.integrator = integrator_name(record.integrator);
      curve.name.settings = method.settings;
      curve.name.sampler = print_setting(record, "sampler.type");
      curve.name.backend = backend;
      curve.name.quantity = estimated_quantity(record.integrator, has_media);
      Method named = method;
      if (named.label.empty()) named.label = curve.name.integrator;
      curve.name.label = curve_label(options, named, curve.name.sampler, backend);
    }
    auto& row = curve.cells.emplace_back();
    for (int i = 0; i < options.seeds; ++i) {
      row.push_back(make_cell(options, *scene, cell, context.name + ", " + curve.name.label,
                              cell_seed(context.base_seed, "curve", spp, i), context.store,
                              context.worker_hash));
    }
  }
  return curve;
}

Expected<void> plan_curves(const SceneContext& context, ScenePlan& plan,
                           std::optional<ReferencePair>& reference) {
  const ReportOptions& options = context.options;
  if (auto checked = check_common_settings(options); !checked) return checked;
  const auto or_default = [](auto values, auto fallback) {
    if (values.empty()) values.push_back(fallback);
    return values;
  };
  for (const Method& method : or_default(options.methods, Method{}))
    for (const std::string& sampler : or_default(options.samplers, std::string()))
      for (const std::string& backend : or_default(options.backends, std::string("native"))) {
        auto curve = plan_curve(context, method, sampler, backend, plan.window, reference);
        if (!curve) return std::unexpected(curve.error());
        const auto same_label = [&](const CurvePlan& other) { return other.name.label == curve->name.label; };
        if (std::ranges::any_of(plan.curves, same_label)) {
          return fail(fmt::format("two methods are called '{}'; give one another name: --integrator LABEL={}",
                                  curve->name.label, curve->name.label));
        }
        plan.curves.push_back(std::move(*curve));
      }
  return {};
}

/// The integrators for the reference: the requested ones, or those chosen for the first method.
ReferencePair reference_methods(const ReportOptions& options, const ReferencePair& chosen) {
  if (options.reference_methods.empty()) return chosen;
  const auto of = [](const Method& method, const char* sampler) {
    return ReferenceMethod{method.integrator, method.settings, sampler};
  };
  return {of(options.reference_methods.front(), "sobol"),
          of(options.reference_methods.back(), "independent")};
}

/// " (max_depth=2, nee=sample)".
std::string settings_text(const std::vector<std::string>& settings) {
  std::string text;
  for (const std::string& setting : settings) {
    const bool own = setting.starts_with("integrator.");
    text += (text.empty() ? " (" : ", ") + setting.substr(own ? std::string("integrator.").size() : 0);
  }
  return text.empty() ? "" : text + ")";
}

Expected<void> plan_rendered_reference(const SceneContext& context, const ReferencePair& chosen,
                                       ScenePlan& plan) {
  const ReportOptions& options = context.options;
  const std::uint32_t spp = half_reference_spp(options.budgets.back(), options.reference_spp);
  // All backends render the same image, so the reference uses the first.
  const std::string backend = options.backends.empty() ? "native" : options.backends.front();
  const auto methods = reference_methods(options, chosen);
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const Method method{"reference", methods[i].integrator, methods[i].settings};
    RenderOptions cell = cell_options(options, context.file, method, methods[i].sampler, backend, spp);
    auto scene = prepare_method(cell, "reference by " + methods[i].integrator, context.store);
    if (!scene) return std::unexpected(scene.error());
    const PreparedRender& prepared = scene->prepared;
    if (i == 0)
      plan.reference_quantity = estimated_quantity(prepared.record.integrator, sees_media(prepared.job));
    ReportOptions once = options;
    once.repeats = 1;
    const std::string role = i == 0 ? "reference A" : "reference B";
    CellPlan planned =
        make_cell(once, *scene, cell, fmt::format("{}, {}", context.name, role),
                  cell_seed(context.base_seed, role, spp, 0), context.store, context.worker_hash);
    planned.what =
        fmt::format("{}, {}: {}{}, {} sampler, seed {}", context.name, role, methods[i].integrator,
                    settings_text(methods[i].settings), methods[i].sampler, *planned.options.scene.seed);
    plan.reference_cells.push_back(std::move(planned));
  }
  return {};
}

Expected<void> check_size(const std::filesystem::path& file, const PixelWindow& window) {
  const auto image = read_image(file);
  if (!image) return std::unexpected(image.error());
  if (image->data == window) return {};
  return fail(fmt::format("the reference {} has {} x {} pixels at ({}, {}), the scene {} x {} at ({}, {})",
                          file.string(), image->data.width, image->data.height, image->data.x, image->data.y,
                          window.width, window.height, window.x, window.y));
}

Expected<void> plan_reference(const SceneContext& context, const std::vector<std::string>& names,
                              const ReferencePair& chosen, ScenePlan& plan) {
  const ReportOptions& options = context.options;
  const std::string file = value_for_scene(options.references, context.name, names).value_or("auto");
  const auto second = value_for_scene(options.second_references, context.name, names);
  if (file == "auto") {
    if (second)
      return fail("--second-reference needs --reference FILE: a reference of ours has two halves already");
    return plan_rendered_reference(context, chosen, plan);
  }
  plan.reference_files.emplace_back(file);
  if (second) plan.reference_files.emplace_back(*second);
  for (const auto& path : plan.reference_files) {
    if (auto sized = check_size(path, plan.window); !sized) return sized;
  }
  return {};
}

Expected<ScenePlan> plan_scene(const SceneContext& context, const std::vector<std::string>& names) {
  ScenePlan plan;
  plan.name = context.name;
  plan.file = context.file;
  std::optional<ReferencePair> reference;
  if (auto planned = plan_curves(context, plan, reference); !planned) return std::unexpected(planned.error());
  if (auto planned = plan_reference(context, names, *reference, plan); !planned)
    return std::unexpected(planned.error());
  for (CurvePlan& curve : plan.curves)
    curve.name.same_quantity =
        plan.reference_quantity.empty() || curve.name.quantity == plan.reference_quantity;
  for (const std::string& value : context.options.peers) {
    const std::size_t equals = value.find('=');
    const std::string scene = value.substr(0, equals == std::string::npos ? 0 : equals);
    const bool named = std::ranges::find(names, scene) != names.end();
    if (!named && names.size() > 1) {
      return fail(fmt::format("--peer {}: with several scenes it is SCENE=DIR, SCENE one of {}", value,
                              fmt::join(names, ", ")));
    }
    if (named && scene != context.name) continue;
    auto peers = find_peers(named ? value.substr(equals + 1) : value, plan.window.width, plan.window.height);
    if (!peers) return std::unexpected(peers.error());
    plan.peers.insert(plan.peers.end(), peers->begin(), peers->end());
  }
  return plan;
}

}  // namespace

std::vector<std::string> scene_names(const std::vector<std::string>& files) {
  std::vector<std::string> names;
  const auto stem = [](const std::string& file) { return std::filesystem::path(file).stem().string(); };
  for (const std::string& file : files) {
    const auto alike =
        std::ranges::count_if(files, [&](const auto& other) { return stem(other) == stem(file); });
    std::string name = stem(file);
    if (alike > 1) {
      const std::string folder = std::filesystem::path(file).parent_path().filename().string();
      if (!folder.empty()) name = folder + "-" + name;
    }
    std::string unique = name;
    for (int i = 2; std::ranges::find(names, unique) != names.end(); ++i)
      unique = fmt::format("{}-{}", name, i);
    names.push_back(unique);
  }
  return names;
}

std::uint32_t cell_seed(std::uint32_t base, const std::string& role, std::uint32_t spp, int index) {
  const std::string text = fmt::format("{}/{}/{}/{}", base, role, spp, index);
  return std::uint32_t(XXH3_64bits(text.data(), text.size()));
}

Expected<std::vector<ScenePlan>> plan_report(const ReportOptions& options, const CellStore& store,
                                             const std::string& worker_hash) {
  BackendsInUse in_use{options.backends.empty(), false};
  for (const std::string& backend : options.backends) {
    in_use.native = in_use.native || backends_in_use(backend).native;
    in_use.opencl = in_use.opencl || backends_in_use(backend).opencl;
  }
  if (const auto used = check_backend_options(in_use, options.render.opencl_device, options.render.isa);
      !used)
    return std::unexpected(used.error());
  const std::vector<std::string> names = scene_names(options.scenes);
  std::vector<ScenePlan> plans;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const SceneContext context{options,           store,    worker_hash,
                               options.scenes[i], names[i], options.render.scene.seed.value_or(0)};
    auto plan = plan_scene(context, names);
    if (!plan) return std::unexpected(plan.error());
    plans.push_back(std::move(*plan));
  }
  return plans;
}

}  // namespace penumbra
