// The interface between a worker process and what computes: the native CPU or an OpenCL device.
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
#include "kernels/host/isa.h"
#include "kernels/host/sample_buffer.h"

namespace penumbra {

/// The work of one unit: a rectangle of pixels and a range of sample indices (kernels/unit.h).
#define UNIT_FIELD(type, name) type name = 0;
struct RenderUnit {
  UNIT_FIELDS(UNIT_FIELD)
};
#undef UNIT_FIELD

/// kAuto: OpenCL on a device that is not a CPU, if there is one that renders the same bits; else native code.
enum class Backend { kNative, kOpenCl, kAuto };
constexpr std::array<std::string_view, 3> kBackendNames{"native", "opencl", "auto"};
constexpr std::string_view backend_name(Backend backend) { return kBackendNames[std::size_t(backend)]; }
/// `name` must be a backend's name.
constexpr Backend backend_from_name(std::string_view name) {
  return name == "opencl" ? Backend::kOpenCl : (name == "auto" ? Backend::kAuto : Backend::kNative);
}

constexpr int kMaxThreads = 1024;

/// By default chosen for the OpenCL device; set by tests and measurements. Images do not depend on it.
struct OpenClTuning {
  std::optional<bool> path_per_item = {};  ///< as on a GPU; by default, whether the device is not a CPU
  std::uint64_t memory_bytes = 0;          ///< upper limit of the device's memory; 0: all of it
  std::uint64_t allocation_bytes = 0;      ///< upper limit of one buffer; 0: the device's limit
  std::int64_t launch_paths = 0;           ///< paths per launch; 0: as many as a launch's time allows
  double launch_seconds = 0;               ///< target time of a launch; 0: 0.25 s, on a CPU 1 s
  std::optional<std::filesystem::path> kernel_cache = {};  ///< default: default_kernel_cache()
  std::string build_options = {};                          ///< additional options for the compiler
};

struct DeviceOptions {
  Backend backend = Backend::kNative;
  int threads = 1;
  Isa isa = Isa::kSse2;          ///< native: must be usable on this machine, see check_isa()
  bool block_of_one = false;     ///< native: blocks of one pixel, for debugging it
  int* probe = nullptr;          ///< native, with block_of_one: see Block::probe
  TracedRays* traced = nullptr;  ///< native: receives what units trace, added to what is there
  /// Its number, or a part of its name or its platform's, see find_opencl_device; empty: the first CPU
  /// device, else any. With kAuto: the only candidate, even if it is a CPU.
  std::string opencl_device = {};
  OpenClTuning opencl_tuning = {};
  /// Called with the device's name before kernels are compiled, which takes seconds. May be empty.
  std::function<void(const std::string& device)> on_compile = {};
};

/// How a device got its compiled kernels.
struct KernelOrigin {
  bool cached = false;  ///< from the cache, not compiled now
  double seconds = 0;   ///< time of compiling, or of loading from the cache
  std::string note;     ///< a message about the cache, or empty
};

struct DevicePreparation {
  std::optional<KernelOrigin> kernels;  ///< empty if they were compiled with the program
  std::vector<std::string> warnings;    ///< for the user
};

/// Renders units of one scene. Not thread-safe; it uses `DeviceOptions::threads` threads of its own.
class Device {
 public:
  virtual ~Device() = default;
  /// For logs and reports, e.g. "native avx512, 2 threads, portable intersector".
  [[nodiscard]] virtual std::string description() const = 0;
  [[nodiscard]] virtual DevicePreparation preparation() const { return {}; }
  virtual Expected<SampleBuffer> render(const RenderUnit& unit) = 0;
  /// Must be called after the view in the scene's header has changed (see kernels/host/view.h).
  virtual Expected<void> take_view() { return {}; }
  /// The number of parts of units (blocks of paths, kernel launches) that are done. It grows while render()
  /// makes progress, so that a hang can be detected. Thread-safe.
  [[nodiscard]] virtual std::uint64_t parts_done() const { return parts_; }

 protected:
  void part_is_done() { parts_.fetch_add(1, std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> parts_ = 0;
};

/// The scene's header selects the intersector; an Embree scene on an OpenCL device is an error. The scene
/// must outlive the device. With kAuto, kernels that do not compile cause a warning, and native code renders.
Expected<std::unique_ptr<Device>> make_device(const DeviceScene& scene, const DeviceOptions& options);

/// An empty result for the unit, with memory for the planes that a device writes for the scene's features,
/// see device_plane_count. Errors: a unit that no device can render.
Expected<SampleBuffer> make_sample_buffer(const RenderUnit& unit, std::uint64_t features);

Expected<Isa> isa_from_name(std::string_view name);
/// Names separated by commas.
inline std::string isa_list(std::span<const Isa> isas) {
  std::string text;
  for (const Isa isa : isas) text.append(text.empty() ? "" : ", ").append(isa_name(isa));
  return text;
}

/// Instruction sets that the kernels are built for, from the narrowest on: at least one.
std::vector<Isa> built_isas();
/// Those of them that this machine supports.
std::vector<Isa> usable_isas();
/// The widest usable one; the narrowest that is built, if none is usable (see check_isa).
Isa best_isa();
/// The error says whether the machine or the build lacks the set, and which sets are available.
Expected<void> check_isa(Isa isa);
Expected<Isa> usable_isa(std::string_view name);

/// The backends that may be used.
struct BackendsInUse {
  bool native = false, opencl = false;
};
/// For native, opencl, auto, or both.
constexpr BackendsInUse backends_in_use(std::string_view name) {
  return {name != "opencl", name != "native"};
}
/// Errors: a device or an instruction set is named (not empty) that none of the backends uses.
Expected<void> check_backend_options(BackendsInUse backends, std::string_view opencl_device,
                                     std::string_view isa);

}  // namespace penumbra
