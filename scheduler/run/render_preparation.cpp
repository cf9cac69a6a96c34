#include "scheduler/run/render_preparation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "kernels/host/console.h"
#include "kernels/host/parallel.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/device/scene_inventory.h"
#include "scheduler/denoise/denoise_image.h"
#include "scheduler/farm/access.h"
#include "scheduler/farm/render_job_check.h"
#include "scheduler/files/output_check.h"
#include "scheduler/files/program_path.h"
#include "scheduler/render/film_scale.h"
#include "scheduler/run/preview_scene.h"
#include "scheduler/watch/tev.h"
#include "worker/opencl_devices.h"

namespace penumbra {
namespace {

constexpr Seconds kPreviewLease = 60;

/// The film whose crop window is the rectangle given by the options.
Expected<Film> cropped_film(const RenderOptions& options, Film film) {
  std::optional<CropRectangle> crop = options.crop;
  if (options.pixel) crop = {options.pixel->x, options.pixel->y, options.pixel->x + 1, options.pixel->y + 1};
  if (crop && options.film_scale != 1) crop = scaled_crop(*crop, options.film_scale, film);
  if (!crop) return film;
  if (crop->x1 > film.width || crop->y1 > film.height) {
    const char* option = options.pixel ? "--pixel" : "--crop";
    return fail(fmt::format("{} reaches outside the film, which is {} x {} pixels{}", option, film.width,
                            film.height, options.scene.scale ? " after --scale" : ""));
  }
  film.crop_x = crop->x0;
  film.crop_y = crop->y0;
  film.crop_width = crop->x1 - crop->x0;
  film.crop_height = crop->y1 - crop->y0;
  return film;
}

Expected<DeviceOptions> device_options(const RenderOptions& options, const DeviceScene& scene) {
  if (const auto checked = check_device_options(options); !checked) return std::unexpected(checked.error());
  DeviceOptions device = device_of(options);
  if (device.backend == Backend::kOpenCl && scene.header.intersector == INTERSECTOR_EMBREE) {
    return fail("this scene is rendered with Embree, which OpenCL has not: add --intersector portable");
  }
  const int cores = int(core_count());
  if (device.threads == 0) device.threads = std::max(1, cores / options.workers);
  // A single pixel is rendered as simply as possible: one thread, one path at a time.
  if (options.pixel) {
    device.threads = 1;
    device.block_of_one = device.backend == Backend::kNative;
  }
  return device;
}

/// The options that ask for what was chosen.
void record_choice(const SettingValues& chosen, RenderRecord& record) {
  record.scene.integrator = integrator_name(record.integrator);
  const auto options = all_render_options();
  for (const auto& [key, value] : chosen)
    if (std::ranges::find(options, key, &RenderOption::sets) == options.end())
      record.scene.settings.push_back(key + "=" + value);
}

/// The request with what the scene and the device decide.
RenderRecord make_record(const RenderOptions& options, const LoadedScene& scene, const Film& film,
                         const DeviceOptions& device) {
  RenderRecord record;
  static_cast<RenderSettings&>(record) = scene.description;
  static_cast<RenderRequest&>(record) = options;
  record.scene_hash = scene.description.contents_hash;
  if (!scene.choice.empty()) record_choice(scene.chosen, record);
  if (record.scene.frame && !record.scene.fps)
    record.scene.fps = scene.description.fps.value_or(kFramesPerSecond);
  record.film = film;
  record.plan = plan_of(options, scene.description.integrator);
  if (record.plan.stop_after == record.sampler.spp) record.plan.stop_after.reset();
  record.scene.intersector = scene.device.header.intersector == INTERSECTOR_EMBREE ? "embree" : "portable";
  if (record.scene.intersector == "embree") record.isa = isa_name(device.isa);
  record.threads = device.threads;
  return record;
}

RenderJob make_job(const RenderOptions& options, const RenderRecord& record, const DeviceOptions& device,
                   DeviceScene scene, const KeptFrame* kept) {
  IntegratorParameters& integrator = scene.header.integrator;
  if (integrator.photons == PHOTONS_PROGRESSIVE)
    integrator.samples_per_map = int(record.plan.samples_per_pass);
  AssetManifest manifest =
      kept != nullptr ? manifest_of(scene, kept->scene, kept->manifest) : manifest_of(scene);
  RenderJob job = job_of_record(record, device, std::move(scene), std::move(manifest));
  job.tev = options.tev;
  job.interactive = options.interactive;
  return job;
}

}  // namespace

DeviceOptions device_of(const RenderRequest& request) {
  return {.backend = request.backend,
          .threads = request.threads,
          .isa = request.isa.empty() ? best_isa() : *isa_from_name(request.isa),
          .opencl_device = request.opencl_device};
}

Expected<void> check_device_options(const RenderRequest& request) {
  if (const auto used = check_backend_options(backends_in_use(backend_name(request.backend)),
                                              request.opencl_device, request.isa);
      !used)
    return used;
  return request.isa.empty() ? Expected<void>() : check_isa(device_of(request).isa);
}

void show_choice(PreparedRender& prepared) {
  if (!prepared.scene.choice.empty()) prepared.job.integrator += " (auto)";
}

FarmOptions farm_of(const RenderOptions& options) {
  FarmOptions farm;
  farm.workers = options.pixel ? 1 : options.workers;
  farm.listen = options.listen;
  farm.address_file = options.address_file;
  set_launch(options, farm);
  // A unit is one sample of a tile, and after every change of the view nothing is known about the workers'
  // speed.
  if (options.interactive) farm.leases.initial = kPreviewLease;
  return farm;
}

void set_launch(const RenderOptions& options, FarmOptions& farm) {
  farm.launch = options.launch;
  if (options.threads > 0) farm.launch_threads = fmt::to_string(options.threads);
}

RenderJob job_of_record(const RenderRecord& record, const DeviceOptions& device, DeviceScene scene,
                        AssetManifest manifest) {
  const Film& film = record.film;
  RenderJob job;
  job.scene = std::move(scene);
  job.manifest = std::make_shared<const AssetManifest>(std::move(manifest));
  job.x = film.crop_x;
  job.y = film.crop_y;
  job.width = film.crop_width;
  job.height = film.crop_height;
  job.spp = record.plan.stop_after.value_or(record.sampler.spp);
  job.request = record;
  job.device = device;
  RenderRecord of_a_part = record;
  of_a_part.plan.adaptive = false;  // a single tile or pixel has no samples to distribute
  job.reproduce_command = repeat_command(of_a_part, false);
  job.title = record.scene.file;
  job.integrator = integrator_name(record.integrator);
  return job;
}

namespace {

Expected<LoadedScene> load_for(const RenderOptions& options) {
  std::function<void(SceneDescription&)> adjust;
  std::uint32_t asked_spp = 0;
  if (options.interactive)
    adjust = [&, preview = preview_adjustment(options.scene)](SceneDescription& scene) {
      asked_spp = scene.sampler.spp;
      preview(scene);
    };
  if (options.film_scale != 1)
    adjust = [&](SceneDescription& scene) { scene.film = scaled_film(scene.film, options.film_scale); };
  auto scene = load_reduced_scene(options.scene, adjust);
  if (scene) scene->asked_spp = asked_spp;
  return scene;
}

}  // namespace

Expected<PreparedRender> prepare_render(const RenderOptions& options, const SceneLoader& load) {
  auto files = choose_output_files(options);
  if (!files) return std::unexpected(files.error());
  // Check what is possible before the scene, which may be large, is read.
  const auto check_files = [&](std::span<const std::filesystem::path> inputs) {
    return options.writes_here && !options.estimate ? check_outputs(files->all(), inputs) : Expected<void>();
  };
  if (auto checked = check_files(std::array{std::filesystem::path(options.scene.file)}); !checked)
    return std::unexpected(checked.error());
  const auto keys = listening_keys(options.listen, options.keys);
  if (!keys) return std::unexpected(keys.error());
  if (!options.tev.empty())
    if (auto address = parse_tev_address(options.tev); !address)
      return fail("--tev: " + address.error().message);
  auto scene = load ? load(options.scene) : load_for(options);
  if (!scene) return std::unexpected(scene.error());
  if (is_denoised(scene->description.film)) add_denoised_files(*files);
  if (auto checked = check_files(scene->description.files); !checked) return std::unexpected(checked.error());
  const auto film = cropped_film(options, scene->description.film);
  if (!film) return std::unexpected(film.error());
  const auto device = device_options(options, scene->device);
  if (!device) return std::unexpected(device.error());
  if (options.plan.stop_after > scene->description.sampler.spp) {
    return fail(fmt::format("--stop-after {}: the render has {} samples per pixel (--spp)",
                            *options.plan.stop_after, scene->description.sampler.spp));
  }
  if (options.time_budget && scene->description.sampler.kind == SamplerKind::kStratified) {
    return fail(
        "--time-budget: the stratified sampler has to know the number of samples; take another sampler");
  }
  if (options.plan.target_error && scene->description.sampler.kind != SamplerKind::kIndependent)
    return fail(
        "--target-error: the samples of this sampler depend on each other, so that their spread is not the "
        "error, and when to stop cannot be told without a bias; add --sampler independent");
  PreparedRender prepared;
  prepared.files = std::move(*files);
  prepared.record = make_record(options, *scene, *film, *device);
  prepared.job = make_job(options, prepared.record, *device, std::move(scene->device), scene->kept.get());
  scene->kept.reset();
  prepared.job.scene_spp = scene->asked_spp > 0 ? scene->asked_spp : prepared.record.sampler.spp;
  prepared.farm = farm_of(options);
  prepared.farm.keys = *keys;
  for (int axis = 0; axis < 3; ++axis) prepared.job.center[axis] = scene->center[axis];
  prepared.scene = std::move(*scene);
  show_choice(prepared);
  if (auto checked = check_render_job(prepared.job); !checked) return std::unexpected(checked.error());
  return prepared;
}

std::expected<PreparedRender, ExitCode> prepare_watched_render(const RenderOptions& options) {
  const auto complain = [](const Error& error, ExitCode code) {
    print_error(error);
    return std::unexpected(code);
  };
  auto prepared = prepare_render(options);
  if (!prepared) return complain(prepared.error(), kBadInput);
  if (const auto device = check_device(prepared->job.device); !device)
    return complain(device.error(), kBadInput);
  if (const auto denoiser = check_denoiser(prepared->record.film.denoise); !denoiser)
    return complain(denoiser.error(), kBadInput);
  for (const std::string& warning : prepared->scene.description.warnings) print_warning(warning);
  if (!prepared->scene.choice.empty() && !options.quiet) print_message(prepared->scene.choice);
  const auto worker = find_program("penumbra-worker");
  if (!worker) return complain(worker.error(), kIncomplete);
  prepared->farm.worker_executable = worker->string();
  prepared->farm.tells_how_to_watch = true;
  return std::move(*prepared);
}

Expected<void> check_device(const DeviceOptions& device) {
  const bool chosen = device.backend == Backend::kAuto && !device.opencl_device.empty();
  if (device.backend != Backend::kOpenCl && !chosen) return {};
  const Expected<OpenClDeviceInfo> found = find_opencl_device(device.opencl_device);
  if (!found) return std::unexpected(found.error());
  return {};
}

}  // namespace penumbra
