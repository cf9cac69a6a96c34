// The intersect and occlude stages of a block with Embree.
#pragma once

#include <memory>

#include "kernels/host/native_kernels.h"
#include "worker/device.h"

struct RTCSceneTy;

namespace penumbra {

class EmbreeTracer {
 public:
  /// Builds Embree's BVH of the scene, with the instruction set of the options: sets choose differently among
  /// equal hits. The scene must outlive the tracer.
  static Expected<std::unique_ptr<EmbreeTracer>> make(const DeviceScene& scene, const DeviceOptions& options);
  ~EmbreeTracer();
  EmbreeTracer(const EmbreeTracer&) = delete;
  EmbreeTracer& operator=(const EmbreeTracer&) = delete;

  /// Functions that pass a block's rays to Embree in packets of 16.
  [[nodiscard]] Tracer tracer() const;
  /// Embree's scene, for other kinds of Embree calls.
  [[nodiscard]] RTCSceneTy* scene() const;

 private:
  EmbreeTracer() = default;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace penumbra
