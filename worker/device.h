// The seam between a worker process and what computes: the native CPU or an OpenCL device.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"

namespace penumbra {

/// A rectangle of pixels and a range of sample indices: the part of an image that one work unit renders.
struct RenderUnit {
  int x = 0, y = 0;  ///< film pixel of the rectangle's corner
  int width = 0, height = 0;
  std::uint32_t first_sample = 0;
  std::uint32_t sample_count = 0;  ///< in [1, kMaxSamplesPerUnit]
  /// Of random numbers: 0 that of the scene's seed, others are independent of it.
  std::uint32_t sequence = 0;
  std::uint32_t spp = 0;  ///< samples of a pixel for which the sequence is made; 0: as many as the scene says
};

/// kAuto: OpenCL on a device that is no CPU, where there is one that renders the same bits; else native code.
enum class Backend { kNative, kOpenCl, kAuto };
constexpr std::array<std::string_view, 3> kBackendNames{"native", "opencl", "auto"};
constexpr std::string_view backend_name(Backend backend) { return kBackendNames[std::size_t(backend)]; }
/// Of a name that is one.
constexpr Backend backend_from_name(std::string_view name) {
  return name == "opencl" ? Backend::kOpenCl : (name == "auto" ? Backend::kAuto : Backend::kNative);
}

constexpr int kMaxThreads = 1024;

enum class Isa { kSse2, kAvx2, kAvx512 };

/// By default chosen to suit the OpenCL device; set for tests and measurements. Pixels do not depend on it.
struct OpenClTuning {
  std::optional<bool> path_per_item = {};  ///< as on a GPU; unless set, whether the device is no CPU
  std::uint64_t memory_bytes = 0;          ///< of the device at most; 0: what there is
  std::uint64_t allocation_bytes = 0;      ///< of one buffer at most; 0: what the device allows
  std::int64_t launch_paths = 0;           ///< a launch holds so many paths; 0: as many as take a moment
  double launch_seconds = 0;               ///< a launch takes about so long; 0: a moment, on a CPU a second
  std::optional<std::filesystem::path> kernel_cache = {};  ///< unless set, default_kernel_cache()
  std::string build_options = {};                          ///< more options for the compiler
};

struct DeviceOptions {
  Backend backend = Backend::kNative;
  int threads = 1;
  Isa isa = Isa::kSse2;       ///< native: must be usable here, see check_isa()
  bool block_of_one = false;  ///< native: one path, one lane at a time, for debugging a pixel
  int* probe = nullptr;       ///< native, a block of one: see Block::probe
  /// Its number or a part of its or its platform's name, see find_opencl_device; empty: the first CPU device,
  /// else any. With kAuto: the only one that comes into question, even if it is a CPU.
  std::string opencl_device = {};
  OpenClTuning opencl_tuning = {};
  /// Called before kernels are compiled, which takes seconds, with the device's name. May be empty.
  std::function<void(const std::string& device)> on_compile = {};
};

/// Where the compiled kernels of a device came from.
struct KernelOrigin {
  bool cached = false;  ///< not compiled now
  double seconds = 0;   ///< of compiling, or of getting them from the cache
  std::string note;     ///< on the cache, if there is anything to say
};

struct DevicePreparation {
  std::optional<KernelOrigin> kernels;  ///< nothing where they were compiled with the program
  std::vector<std::string> warnings;    ///< for the user
};

/// Renders units of one scene. Not thread-safe; uses `DeviceOptions::threads` threads of its own.
class Device {
 public:
  virtual ~Device() = default;
  /// For logs and reports, e.g. "native avx512, 2 threads, portable intersector".
  [[nodiscard]] virtual std::string description() const = 0;
  [[nodiscard]] virtual DevicePreparation preparation() const { return {}; }
  virtual Expected<SampleBuffer> render(const RenderUnit& unit) = 0;
  /// To be called after the view in the scene's header has changed (see kernels/host/view.h).
  virtual Expected<void> take_view() { return {}; }
  /// How many parts of units (blocks of paths, kernel launches) are done so far. It grows while render() gets
  /// on, and stands still where nothing goes on. From any thread.
  [[nodiscard]] virtual std::uint64_t parts_done() const { return parts_; }

 protected:
  void part_is_done() { parts_.fetch_add(1, std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> parts_ = 0;
};

/// The scene names its intersector; an Embree scene on an OpenCL device is an error. The scene must outlive
/// the device. With kAuto a device whose kernels do not compile is a warning, and native code renders.
Expected<std::unique_ptr<Device>> make_device(const DeviceScene& scene, const DeviceOptions& options);

/// An empty result for the unit, with room for the planes that a device writes for the scene's features, see
/// device_plane_count. The error names a unit that no device can render.
Expected<SampleBuffer> make_sample_buffer(const RenderUnit& unit, std::uint64_t features);

constexpr std::array<Isa, 3> kIsas{Isa::kSse2, Isa::kAvx2, Isa::kAvx512};
constexpr std::array<std::string_view, 3> kIsaNames{"sse2", "avx2", "avx512"};
constexpr std::string_view isa_name(Isa isa) { return kIsaNames[std::size_t(isa)]; }
Expected<Isa> isa_from_name(std::string_view name);
/// Their names, with commas.
inline std::string isa_list(std::span<const Isa> isas) {
  std::string text;
  for (const Isa isa : isas) text.append(text.empty() ? "" : ", ").append(isa_name(isa));
  return text;
}

/// Instruction sets that the kernels are built for, from the narrowest, which is SSE2, on.
std::vector<Isa> built_isas();
/// Those of them that this machine has.
std::vector<Isa> usable_isas();
/// The widest of those.
Isa best_isa();
/// The error says whether the machine or the build lacks the set, and which are there.
Expected<void> check_isa(Isa isa);
Expected<Isa> usable_isa(std::string_view name);

/// Which backends may come to compute.
struct BackendsInUse {
  bool native = false, opencl = false;
};
/// Of native, opencl, auto, or both.
constexpr BackendsInUse backends_in_use(std::string_view name) {
  return {name != "opencl", name != "native"};
}
/// Fails if a device or an instruction set is named (not empty) that none of the backends uses.
Expected<void> check_backend_options(BackendsInUse backends, std::string_view opencl_device,
                                     std::string_view isa);

}  // namespace penumbra
