#include "worker/opencl_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "kernels/host/process.h"
#include "worker/kernel_unit.h"
#include "worker/opencl_memory.h"
#include "worker/opencl_session.h"
#include "worker/photon_maps.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLaunchSeconds = 0.25;         // watchdogs kill after about 2 s
constexpr double kCpuLaunchSeconds = 1;         // so that the worker can show progress
constexpr std::int64_t kFirstLaunch = 1 << 14;  // paths, before any time is known
// Photons that a launch has room for; and how many a path is expected to have.
constexpr std::uint64_t kPhotonRoom = 1 << 19;
constexpr std::uint64_t kPhotonItems = 1 << 16;  // with a path per work item
constexpr int kExpectedPhotons = 8;
constexpr std::size_t kLargestGroup = 64;  // work items; larger groups share no memory and gain nothing

class OpenClDevice final : public Device {
 public:
  static Expected<std::unique_ptr<Device>> make(const DeviceScene& scene, const DeviceOptions& options,
                                                const OpenClDeviceInfo& info) {
    if (scene.header.intersector == INTERSECTOR_EMBREE)
      return fail(
          "OpenCL kernels trace with the portable intersector; use --intersector portable with --backend "
          "opencl");
    std::unique_ptr<OpenClDevice> device(new OpenClDevice(info, options, scene));
    if (Expected<void> done = device->set_up(options); !done) return std::unexpected(done.error());
    return device;
  }

  /// Buffers must not be released while commands run: PoCL crashes otherwise.
  ~OpenClDevice() override { session_.wait(); }

  std::string description() const override {
    return fmt::format("OpenCL {} ({}), features {:#x}, {}", info().name, info().platform, features_,
                       shape_.blocks ? fmt::format("{} work items", items_) : "a path a work item");
  }

  DevicePreparation preparation() const override { return preparation_; }

  Expected<SampleBuffer> render(const RenderUnit& unit) override {
    Expected<SampleBuffer> made = make_sample_buffer(unit, features_);
    if (!made) return made;
    SampleBuffer& result = *made;
    if (Expected<void> ready = reserve(unit); !ready) return std::unexpected(ready.error());
    if (Expected<void> ready = use_photons(unit); !ready) return std::unexpected(ready.error());
    for (int y = 0; y < unit.height; y += plan_.part_height)
      for (int x = 0; x < unit.width; x += plan_.part_width) {
        Unit part = kernel_unit(unit);
        part.x += x;
        part.y += y;
        part.width = std::min(plan_.part_width, unit.width - x);
        part.height = std::min(plan_.part_height, unit.height - y);
        if (shape_.blocks ? !launch_blocks(part) : !launch_paths(part)) return std::unexpected(error());
        if (!take_counters(part, result) || !take_pixels(part, x, y, result)) return std::unexpected(error());
      }
    if ((features_ & FEATURE_MATTES) != 0u) take_mattes(result);
    return made;
  }

  Expected<void> take_view() override {
    if (!session_.wait() || !upload_header()) return std::unexpected(error());
    return {};
  }

 private:
  OpenClDevice(OpenClDeviceInfo device, const DeviceOptions& options, const DeviceScene& scene)
      : session_(std::move(device)),
        scene_(scene),
        shape_(options.opencl_tuning.path_per_item.value_or(!info().is_cpu) ? kGpuShape : kCpuShape),
        // A CPU device runs one work item per core, so this many keep that many cores busy. (Dividing the
        // device would be more direct, but PoCL 3.1 crashes on sub-devices.)
        items_(std::max(1, options.threads)),
        features_(scene.header.features),
        photon_maps_([this](const PhotonTask& task) { return trace_photons(task); }) {
    const OpenClTuning& tuning = options.opencl_tuning;
    limits_ = {tuning.memory_bytes ? tuning.memory_bytes : info().memory_bytes,
               tuning.allocation_bytes ? tuning.allocation_bytes : info().max_allocation_bytes};
    if (tuning.launch_paths > 0)
      launch_ = LaunchSize::fixed(tuning.launch_paths);
    else if (tuning.launch_seconds > 0)
      launch_ = LaunchSize::timed(tuning.launch_seconds, kFirstLaunch);
    else
      launch_ = LaunchSize::timed(info().is_cpu ? kCpuLaunchSeconds : kLaunchSeconds, kFirstLaunch);
  }

  // --- Setting up

  Expected<void> set_up(const DeviceOptions& options) {
    if (std::string lacking = lacking_for(info(), features_); !lacking.empty()) return fail(lacking);
    if (!session_.open()) return std::unexpected(error());
    scene_bytes_ = sizeof scene_.header + scene_.words.size() * 4;
    // Checks before compiling that one pixel with one sample fits.
    const RenderUnit least{.x = 0, .y = 0, .width = 1, .height = 1, .first_sample = 0, .sample_count = 1};
    if (auto fits = plan(least); !fits) return std::unexpected(fits.error());
    // A CPU device uses the scene's memory in place: the scene outlives the device.
    if (!upload_header() ||
        !session_.upload(words_, scene_.words.data(), scene_.words.size() * 4, info().is_cpu) ||
        !session_.allocate(next_block_, sizeof(cl_int)) || !session_.allocate(photons_, sizeof(cl_uint)))
      return std::unexpected(error());
    if (!info().is_exact)
      preparation_.warnings.push_back(
          info().name +
          " rounds floats in its own way: the image differs in its last bits from other devices'");
    return make_kernels(options);
  }

  bool upload_header() { return session_.upload(header_, &scene_.header, sizeof scene_.header, false); }

  Expected<void> make_kernels(const DeviceOptions& options) {
    const OpenClTuning& tuning = options.opencl_tuning;
    OpenClSource source =
        opencl_source(info(), "kernels/opencl.cl", {}, needs_of(scene_.header), shape_.lanes);
    if (!info().is_cpu) source.options += " -DINLINE_STAGES";
    // Allows twice as many paths at once as with all registers that the compiler would use.
    if (info().limits_registers) source.options += " -cl-nv-maxrregcount=128";
    if (!tuning.build_options.empty()) source.options += " " + tuning.build_options;
    const CheckedCache cache = kernel_cache(tuning.kernel_cache.value_or(default_kernel_cache()));
    const auto start = [this](ClProgram program) {
      trace_.reset();
      finish_.reset();
      emit_.reset();
      program_ = std::move(program);
      return create_kernels() && first_launch();
    };
    Expected<KernelOrigin> origin = session_.start_program(source, cache, start, [&] {
      if (options.on_compile) options.on_compile(info().name);
    });
    if (!origin) return std::unexpected(origin.error());
    preparation_.kernels = std::move(*origin);
    return {};
  }

  bool create_kernels() {
    cl_int status = CL_SUCCESS;
    trace_.reset(clCreateKernel(program_.get(), shape_.blocks ? "render_blocks" : "trace_paths", &status));
    if (!session_.good(status, "create the kernel")) return false;
    if ((features_ & FEATURE_PHOTONS) != 0u) {
      emit_.reset(clCreateKernel(program_.get(), "trace_photon_paths", &status));
      if (!session_.good(status, "create the kernel")) return false;
    }
    if (shape_.blocks) return true;
    if (emit_) emit_group_ = session_.group_size(emit_.get(), kLargestGroup);
    finish_.reset(clCreateKernel(program_.get(), "finish_samples", &status));
    if (!session_.good(status, "create the kernel")) return false;
    group_ = std::min(session_.group_size(trace_.get(), kLargestGroup),
                      session_.group_size(finish_.get(), kLargestGroup));
    return true;
  }

  /// Launches each kernel without rendering anything: drivers finish compiling at the first launch.
  bool first_launch() {
    const RenderUnit pixel{.x = 0, .y = 0, .width = 1, .height = 1, .first_sample = 0, .sample_count = 1};
    if (!reserve(pixel)) return false;
    const Unit unit = kernel_unit(pixel);
    if (emit_ && !(reserve_photons() && launch_photons({.map = 0, .sequence = 0, .paths = 1}, 0, 0, 1) &&
                   session_.wait()))
      return false;
    if (shape_.blocks) return launch_range(unit, 0, 0, 1) && session_.wait();
    return launch_trace(unit, 0, 0, 0) && launch_finish(unit, 0, 0, 0) && session_.wait();
  }

  // --- Memory

  Expected<OpenClMemoryPlan> plan(const RenderUnit& unit) {
    demand_ = {.scene_bytes = scene_bytes_,
               .photon_bytes = photon_bytes_,
               .path_words = std::uint64_t(path_words(features_)),
               .slot_words = std::uint64_t(slot_words(features_)),
               .planes = std::uint64_t(device_plane_count(features_, unit.sample_count)),
               .bad_bytes = sizeof(BadSamples) * BAD_KINDS,
               .width = unit.width,
               .height = unit.height,
               .samples = int(unit.sample_count),
               .items = items_};
    return plan_opencl_memory(shape_, demand_, limits_, info().name);
  }

  /// Allocates block memory and results for the unit. Buffers that are large enough are kept.
  Expected<void> reserve(const RenderUnit& unit) {
    const Expected<OpenClMemoryPlan> wanted = plan(unit);
    if (!wanted) return std::unexpected(wanted.error());
    plan_ = *wanted;
    const std::pair<ClReserve*, std::uint64_t> buffers[] = {{&paths_, plan_.path_bytes(demand_)},
                                                            {&slots_, plan_.slot_bytes(demand_)},
                                                            {&bad_, plan_.bad_bytes(demand_)},
                                                            {&out_, plan_.result_bytes(demand_)}};
    // Each buffer fits, but not together with larger ones from before.
    std::uint64_t held = scene_bytes_ + photon_bytes_;
    for (const auto& [buffer, bytes] : buffers) held += std::max(buffer->bytes, bytes);
    if (held > limits_.memory && !session_.wait()) return std::unexpected(error());
    for (const auto& [buffer, bytes] : buffers)
      if (held > limits_.memory) *buffer = {};
    for (const auto& [buffer, bytes] : buffers)
      if (!session_.reserve(*buffer, bytes)) return std::unexpected(error());
    const std::size_t counters = std::size_t(plan_.finishing_items) * BAD_KINDS;
    if (counters > counters_.size()) counters_.resize(counters);
    return {};
  }

  // --- Launching

  /// Renders the unit by blocks of paths, mostly in one launch.
  bool launch_blocks(const Unit& unit) {
    const int pixels = unit.width * unit.height, samples = unit.sample_count;
    // As few pixels per block as keep every work item busy, and at most as many as a block has slots for.
    const int share = (pixels + plan_.items - 1) / plan_.items;
    const int block_pixels = std::max(1, std::min(slot_pixels(plan_.slots, samples, shape_.lanes), share));
    for (int first = 0; first < pixels;) {
      const std::int64_t wanted = std::max<std::int64_t>(launch_.paths() / samples, 1);
      const int count = int(std::min<std::int64_t>(wanted, pixels - first));
      const auto begin = Clock::now();
      if (!launch_range(unit, first, first + count, block_pixels)) return false;
      if (launch_.is_timed()) {
        if (!session_.wait()) return false;
        launch_.took(std::int64_t(count) * samples, seconds_since(begin));
        part_is_done();
      }
      first += count;
    }
    return true;
  }

  bool launch_range(const Unit& unit, int first, int end, int block_pixels) {
    if (!session_.clear(next_block_, sizeof(cl_int))) return false;
    ClArguments arguments(trace_.get());
    arguments << header_ << words_ << photons_ << unit << first << end << block_pixels << plan_.paths
              << plan_.slots << paths_ << slots_ << out_ << bad_ << next_block_;
    return session_.launch(arguments, std::size_t(plan_.items), 1);
  }

  /// Renders the unit by single paths: as many pixels at a time as there are slots for, first their paths in
  /// short launches, then their statistics.
  bool launch_paths(const Unit& unit) {
    const int pixels = unit.width * unit.height, samples = unit.sample_count;
    const int chunk = plan_.slots / samples;
    for (int first_pixel = 0; first_pixel < pixels; first_pixel += chunk) {
      const int count = std::min(chunk, pixels - first_pixel), paths = count * samples;
      for (int first = 0; first < paths;) {
        const int now = int(std::min<std::int64_t>(launch_.paths(), std::min(plan_.items, paths - first)));
        const auto begin = Clock::now();
        if (!launch_trace(unit, first_pixel, first, now)) return false;
        if (launch_.is_timed()) {
          if (!session_.wait()) return false;
          launch_.took(now, seconds_since(begin));
          part_is_done();
        }
        first += now;
      }
      const std::int64_t most = std::max<std::int64_t>(launch_.paths() / samples, 1);
      for (int from = 0; from < count;) {
        const int now = int(std::min<std::int64_t>(most, std::min(plan_.finishing_items, count - from)));
        if (!launch_finish(unit, first_pixel, from, now)) return false;
        from += now;
      }
    }
    return true;
  }

  bool launch_trace(const Unit& unit, int first_pixel, int first, int count) {
    ClArguments arguments(trace_.get());
    arguments << header_ << words_ << photons_ << unit << first_pixel << first << count << plan_.paths
              << plan_.slots << paths_ << slots_;
    return session_.launch(arguments, std::size_t(count), group_);
  }

  bool launch_finish(const Unit& unit, int first_pixel, int from, int count) {
    ClArguments arguments(finish_.get());
    arguments << header_ << words_ << photons_ << unit << first_pixel << from << count << plan_.slots
              << slots_ << out_ << bad_;
    return session_.launch(arguments, std::size_t(count), group_);
  }

  // --- Photons

  /// Makes the photon maps of the unit and uploads them, unless they are there.
  Expected<void> use_photons(const RenderUnit& unit) {
    const auto maps = photon_maps_.of_unit(scene_.header, unit);
    if (!maps) return std::unexpected(maps.error());
    if (*maps == nullptr || (*maps)->number == uploaded_) return {};
    uploaded_ = 0;
    photon_bytes_ = (*maps)->words.size() * sizeof(std::uint32_t);
    if (!session_.wait() || !session_.upload(photons_, (*maps)->words.data(), photon_bytes_, info().is_cpu))
      return std::unexpected(error());
    uploaded_ = (*maps)->number;
    return reserve(unit);
  }

  /// Memory for the photons of a launch and, where work items have a path each, for their paths.
  bool reserve_photons() {
    const std::uint64_t path_bytes = sizeof(cl_uint) * std::uint64_t(path_words(features_));
    photon_room_ = int(std::clamp<std::uint64_t>(limits_.allocation / sizeof(Photon), 1, kPhotonRoom));
    photon_items_ = int(std::clamp<std::uint64_t>(limits_.allocation / path_bytes, 1, kPhotonItems));
    return session_.reserve(traced_photons_, std::uint64_t(photon_room_) * sizeof(Photon)) &&
           session_.reserve(photon_count_, sizeof(cl_int)) &&
           (shape_.blocks || session_.reserve(photon_paths_, path_bytes * std::uint64_t(photon_items_)));
  }

  /// Traces photon paths in launches whose photons have room in one buffer.
  Expected<std::vector<Photon>> trace_photons(const PhotonTask& task) {
    if (!reserve_photons()) return std::unexpected(error());
    std::vector<Photon> photons;
    int wanted = std::max(1, photon_room_ / kExpectedPhotons);
    if (!shape_.blocks) wanted = std::min(wanted, photon_items_);
    for (int first = 0; first < task.paths;) {
      const int now = std::min(wanted, task.paths - first);
      int count = 0;
      if (!launch_photons(task, first, now, photon_room_) ||
          !session_.read(photon_count_, &count, sizeof(cl_int)))
        return std::unexpected(error());
      part_is_done();
      if (count > photon_room_ && now == 1)
        return fail("a photon arrives at too many surfaces for the device's memory");
      if (count > photon_room_) {
        wanted = std::max(1, now / 2);
        continue;
      }
      const std::size_t before = photons.size();
      if (before + std::size_t(count) > kMostPhotons) return std::unexpected(too_many_photons());
      photons.resize(before + std::size_t(count));
      if (count > 0 &&
          !session_.read(traced_photons_, photons.data() + before, std::size_t(count) * sizeof(Photon)))
        return std::unexpected(error());
      first += now;
    }
    return photons;
  }

  bool launch_photons(const PhotonTask& task, int first, int count, int room) {
    if (!session_.clear(next_block_, sizeof(cl_int)) || !session_.clear(photon_count_.buffer, sizeof(cl_int)))
      return false;
    ClArguments arguments(emit_.get());
    arguments << header_ << words_ << int(task.map) << int(task.sequence) << task.paths << first
              << first + count << (shape_.blocks ? plan_.paths : photon_items_)
              << (shape_.blocks ? paths_ : photon_paths_) << traced_photons_ << photon_count_ << room
              << next_block_;
    const std::size_t items = shape_.blocks ? std::size_t(plan_.items) : std::size_t(count);
    return session_.launch(arguments, items, shape_.blocks ? 1 : emit_group_);
  }

  // --- Results

  bool take_counters(const Unit& part, SampleBuffer& result) {
    const std::size_t count = std::size_t(plan_.finishing_items) * BAD_KINDS;
    if (!session_.read(bad_, counters_.data(), count * sizeof(BadSamples))) return false;
    bool any = false;
    for (std::size_t i = 0; i < count; ++i) {
      result.flagged[i % BAD_KINDS].add(flagged_samples(part, counters_[i]));
      any = any || counters_[i].count != 0;
    }
    return !any || session_.clear(bad_.buffer, bad_.bytes);
  }

  /// Copies the part's planes into those of the unit; (x, y) is the part's first pixel in the unit.
  bool take_pixels(const Unit& part, int x, int y, SampleBuffer& result) {
    const std::size_t area = std::size_t(part.width) * std::size_t(part.height);
    const auto planes = std::size_t(demand_.planes);
    const std::size_t values = area * planes;
    if (area == result.pixels()) return session_.read(out_, result.values.data(), values * sizeof(float));
    if (values > part_values_.size()) part_values_.resize(values);
    if (!session_.read(out_, part_values_.data(), values * sizeof(float))) return false;
    const std::size_t width = std::size_t(part.width);
    for (std::size_t row = 0; row < planes * std::size_t(part.height); ++row) {
      const std::size_t plane = row / std::size_t(part.height), line = row % std::size_t(part.height);
      float* to = result.values.data() + plane * result.pixels() +
                  (std::size_t(y) + line) * std::size_t(result.width) + std::size_t(x);
      std::copy_n(part_values_.data() + row * width, width, to);
    }
    return true;
  }

  [[nodiscard]] const OpenClDeviceInfo& info() const { return session_.info(); }
  [[nodiscard]] Error error() const { return session_.error(); }

  OpenClSession session_;
  const DeviceScene& scene_;
  BlockShape shape_;
  int items_;
  std::uint64_t features_;
  PhotonMaps photon_maps_;  // before photons_, which may use its memory
  OpenClLimits limits_;
  LaunchSize launch_ = LaunchSize::timed(kLaunchSeconds, kFirstLaunch);
  DevicePreparation preparation_;

  ClProgram program_;
  ClKernel trace_, finish_;  // finish_: with one path per work item
  ClKernel emit_;            // with FEATURE_PHOTONS
  std::size_t group_ = 1, emit_group_ = 1;
  std::uint64_t scene_bytes_ = 0;
  OpenClDemand demand_;
  OpenClMemoryPlan plan_;
  ClBuffer header_, words_, next_block_;
  ClBuffer photons_;  // the words of maps number `uploaded_`
  std::uint64_t uploaded_ = 0, photon_bytes_ = 0;
  ClReserve paths_, slots_, out_, bad_, photon_paths_, traced_photons_, photon_count_;
  int photon_room_ = 0, photon_items_ = 0;
  std::vector<BadSamples> counters_;
  std::vector<float> part_values_;
};

}  // namespace

Expected<std::unique_ptr<Device>> make_opencl_device(const DeviceScene& scene, const DeviceOptions& options,
                                                     const OpenClDeviceInfo& info) {
  return OpenClDevice::make(scene, options, info);
}

Expected<std::unique_ptr<Device>> make_opencl_device(const DeviceScene& scene, const DeviceOptions& options) {
  const Expected<OpenClDeviceInfo> info = find_opencl_device(options.opencl_device);
  if (!info) return std::unexpected(info.error());
  return OpenClDevice::make(scene, options, *info);
}

}  // namespace penumbra
