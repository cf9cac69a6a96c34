// The seam between a worker process and what computes: the native CPU or an OpenCL device.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

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
};

enum class Backend { kNative, kOpenCl };
enum class Isa { kSse2, kAvx2, kAvx512 };

struct DeviceOptions {
  Backend backend = Backend::kNative;
  int threads = 1;
  Isa isa = Isa::kAvx2;       ///< native: must be one that this machine has, see best_isa()
  bool block_of_one = false;  ///< native: one path, one lane at a time, for debugging a pixel
  int* probe = nullptr;       ///< native, a block of one: see Block::probe
  std::string
      opencl_device;  ///< part of a platform's or device's name; empty: the first CPU device, else any
};

/// Renders units of one scene. Not thread-safe; uses `DeviceOptions::threads` threads of its own.
class Device {
 public:
  virtual ~Device() = default;
  /// For logs and reports, e.g. "native avx512, 2 threads, portable intersector".
  [[nodiscard]] virtual std::string description() const = 0;
  virtual Expected<SampleBuffer> render(const RenderUnit& unit) = 0;
};

/// The scene names its intersector; an Embree scene on an OpenCL device is an error. The scene must outlive
/// the device.
Expected<std::unique_ptr<Device>> make_device(const DeviceScene& scene, const DeviceOptions& options);

/// An empty result for the unit, with the planes that the scene's features ask for. The error names a unit
/// that no device can render.
Expected<SampleBuffer> make_sample_buffer(const RenderUnit& unit, std::uint32_t features);

/// The widest instruction set that this machine has and the kernels are built for.
Isa best_isa();
constexpr std::array<std::string_view, 3> kIsaNames{"sse2", "avx2", "avx512"};
constexpr std::string_view isa_name(Isa isa) { return kIsaNames[std::size_t(isa)]; }
Expected<Isa> isa_from_name(std::string_view name);

}  // namespace penumbra
