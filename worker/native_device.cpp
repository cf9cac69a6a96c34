#include "worker/native_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "kernels/host/block_memory.h"
#include "kernels/host/text.h"
#include "worker/embree_tracer.h"
#include "worker/kernel_unit.h"
#include "worker/photon_maps.h"
#include "worker/search_choice.h"

namespace penumbra {
namespace {

// Stride of the state's arrays: with a power of two, all fields of a path would share one cache set.
constexpr int kBlockStride = kBlockPaths + 16;
// For all samples of a pixel, and for lanes beyond them.
constexpr int kSlots = int(kMaxSamplesPerUnit) + 16;

// Room for photons that usually suffices. A block with more is traced again.
constexpr int kPhotonsPerPath = 8;

/// Threads that wait for work: a unit takes a few milliseconds, too short for starting threads. If the system
/// does not provide all wanted threads, the team is smaller.
class ThreadTeam {
 public:
  explicit ThreadTeam(int size) {
    threads_.reserve(std::size_t(size));
    try {
      for (int i = 1; i < size; ++i) threads_.emplace_back([this, i] { serve(i); });
    } catch (const std::system_error& error) {
      shortage_ = fmt::format("the system gives {} of {} threads ({}): this worker goes on with those",
                              this->size(), size, error.code().message());
    }
  }
  ~ThreadTeam() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    start_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  [[nodiscard]] int size() const { return int(threads_.size()) + 1; }
  /// Why the team is smaller than requested, or empty.
  [[nodiscard]] const std::string& shortage() const { return shortage_; }

  /// Calls work(0) ... work(size - 1), the first on the calling thread, and waits for all.
  void run(const std::function<void(int)>& work) {
    {
      const std::lock_guard lock(mutex_);
      work_ = &work;
      running_ = int(threads_.size());
      ++generation_;
    }
    start_.notify_all();
    work(0);
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return running_ == 0; });
  }

 private:
  void serve(int index) {
    int seen = 0;
    for (;;) {
      const std::function<void(int)>* work;
      {
        std::unique_lock lock(mutex_);
        start_.wait(lock, [&] { return stopping_ || generation_ != seen; });
        if (stopping_) return;
        seen = generation_;
        work = work_;
      }
      (*work)(index);
      const std::lock_guard lock(mutex_);
      if (--running_ == 0) done_.notify_one();
    }
  }

  std::vector<std::thread> threads_;
  std::string shortage_;
  std::mutex mutex_;
  std::condition_variable start_, done_;
  const std::function<void(int)>* work_ = nullptr;
  int generation_ = 0, running_ = 0;
  bool stopping_ = false;
};

class NativeDevice final : public Device {
 public:
  /// `whole`: test every primitive even though the scene has a BVH.
  NativeDevice(const DeviceScene& scene, const DeviceOptions& options, const NativeKernel& kernel, bool whole,
               std::unique_ptr<EmbreeTracer> tracer)
      : scene_(scene),
        options_(options),
        kernel_(kernel),
        whole_(whole),
        tracer_(std::move(tracer)),
        team_(std::max(1, options.threads)),
        photon_maps_([this](const PhotonTask& task) { return trace_photons(task); }) {}

  std::string description() const override {
    return fmt::format("native {}{}, {} intersector, {}", isa_name(options_.isa),
                       options_.block_of_one ? " (block of one)" : "", tracer_ ? "Embree" : "portable",
                       counted(team_.size(), "thread"));
  }

  DevicePreparation preparation() const override {
    if (team_.shortage().empty()) return {};
    return {.kernels = {}, .warnings = {team_.shortage()}};
  }

  Expected<SampleBuffer> render(const RenderUnit& unit) override {
    Expected<SampleBuffer> made = make_sample_buffer(unit, scene_.header.features);
    if (!made) return made;
    SampleBuffer& result = *made;

    make_blocks();
    const auto photons = photon_maps_.of_unit(scene_.header, unit);
    if (!photons) return std::unexpected(photons.error());
    const std::uint32_t* photon_words = *photons != nullptr ? (*photons)->words.data() : nullptr;

    const int samples = int(unit.sample_count);
    const int pixels = int(result.pixels());
    // Smaller blocks if there would be fewer blocks than threads.
    const int share = (pixels + team_.size() - 1) / team_.size();
    const int block_pixels = options_.block_of_one ? 1 : std::max(1, std::min(kBlockPaths / samples, share));

    const SceneHeader header = traced_header();
    const Unit portable = kernel_unit(unit);
    const Tracer tracer = tracer_ ? tracer_->tracer() : Tracer{};
    std::atomic<int> next{0};
    std::mutex noting;
    team_.run([&](int thread) {
      Block block = blocks_[std::size_t(thread)].block();
      block.probe = options_.probe;
      TracedRays traced{};
      if (options_.traced != nullptr) block.traced = &traced;
      BadSamples bad[BAD_KINDS] = {};
      for (int first; (first = next.fetch_add(block_pixels)) < pixels; part_is_done())
        kernel_.render_block(header, scene_.words.data(), photon_words, tracer, portable, first,
                             std::min(block_pixels, pixels - first), block, result.values.data(), bad);
      const std::lock_guard lock(noting);
      note_traced(traced);
      for (int kind = 0; kind < BAD_KINDS; ++kind)
        result.flagged[std::size_t(kind)].add(flagged_samples(portable, bad[kind]));
    });
    if ((scene_.header.features & FEATURE_MATTES) != 0u) take_mattes(result);
    return made;
  }

 private:
  [[nodiscard]] int capacity() const { return options_.block_of_one ? kernel_.lanes : kBlockStride; }
  /// The scene's header, with the search that this device prefers.
  [[nodiscard]] SceneHeader traced_header() const {
    SceneHeader header = scene_.header;
    if (whole_) header.features &= ~std::uint64_t(FEATURE_BVH);
    return header;
  }
  void note_traced(const TracedRays& more) const {
    if (options_.traced == nullptr) return;
    options_.traced->rays += more.rays;
    options_.traced->shadow_rays += more.shadow_rays;
    options_.traced->photon_rays += more.photon_rays;
  }
  void make_blocks() {
    while (blocks_.size() < std::size_t(team_.size()))
      blocks_.emplace_back(scene_.header.features, capacity(), kSlots);
  }

  Expected<std::vector<Photon>> trace_photons(const PhotonTask& task) {
    const SceneHeader header = traced_header();
    const Tracer tracer = tracer_ ? tracer_->tracer() : Tracer{};
    const int block_paths = options_.block_of_one ? kernel_.lanes : kBlockPaths;
    const int blocks = (task.paths + block_paths - 1) / block_paths;
    std::vector<std::vector<Photon>> traced(std::size_t(std::max(blocks, 0)));
    std::atomic<int> next{0};
    std::atomic<std::size_t> stored{0};
    std::mutex noting;
    team_.run([&](int thread) {
      Block block = blocks_[std::size_t(thread)].block();
      TracedRays traced_rays{};
      if (options_.traced != nullptr) block.traced = &traced_rays;
      std::vector<Photon> room(std::size_t(block_paths) * kPhotonsPerPath);
      for (int b; stored <= kMostPhotons && (b = next.fetch_add(1)) < blocks; part_is_done()) {
        const int first = b * block_paths, paths = std::min(block_paths, task.paths - first);
        int count = 0;
        const auto trace = [&] {
          count = 0;
          kernel_.trace_photons(header, scene_.words.data(), tracer, task, first, paths, block,
                                {room.data(), &count, int(room.size())});
        };
        trace();
        if ((stored += std::size_t(count)) > kMostPhotons) break;
        if (std::size_t(count) > room.size()) {
          room.resize(std::size_t(count));
          trace();
        }
        traced[std::size_t(b)].assign(room.begin(), room.begin() + count);
      }
      const std::lock_guard lock(noting);
      note_traced(traced_rays);
    });
    if (stored > kMostPhotons) return std::unexpected(too_many_photons());
    std::vector<Photon> all;
    all.reserve(stored);
    for (const std::vector<Photon>& some : traced) all.insert(all.end(), some.begin(), some.end());
    return all;
  }

  const DeviceScene& scene_;
  DeviceOptions options_;
  const NativeKernel& kernel_;
  bool whole_;
  std::unique_ptr<EmbreeTracer> tracer_;
  ThreadTeam team_;
  std::vector<BlockMemory> blocks_;
  PhotonMaps photon_maps_;
};

/// Whether testing every primitive is possible and faster than the scene's BVH. Images do not depend on it.
bool prefers_whole(Isa isa, const DeviceScene& scene) {
  const bool either = (scene.header.features & FEATURE_BVH) != 0 && scene.header.tables.corners.count > 0;
  return either && tests_every_primitive(isa, scene);
}

}  // namespace

Expected<std::unique_ptr<Device>> make_native_device(const DeviceScene& scene, const DeviceOptions& options) {
  if (const Expected<void> usable = check_isa(options.isa); !usable) return std::unexpected(usable.error());
  const NativeKernel* kernel = find_native_kernel(options.isa);
  std::unique_ptr<EmbreeTracer> tracer;
  if (scene.header.intersector == INTERSECTOR_EMBREE) {
    Expected<std::unique_ptr<EmbreeTracer>> made = EmbreeTracer::make(scene, options);
    if (!made) return std::unexpected(made.error());
    tracer = std::move(*made);
  }
  return std::make_unique<NativeDevice>(scene, options, *kernel, prefers_whole(options.isa, scene),
                                        std::move(tracer));
}

}  // namespace penumbra
