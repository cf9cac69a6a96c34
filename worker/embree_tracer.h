// The intersect and occlude stages of a block by Embree.
#pragma once

#include <memory>

#include "kernels/host/native_kernels.h"
#include "worker/device.h"

struct RTCSceneTy;

namespace penumbra {

class EmbreeTracer {
 public:
  /// Builds Embree's hierarchy over the scene with the instruction set of the options: its choices among
  /// equal hits differ between sets. The scene must outlive the tracer.
  static Expected<std::unique_ptr<EmbreeTracer>> make(const DeviceScene& scene, const DeviceOptions& options);
  ~EmbreeTracer();
  EmbreeTracer(const EmbreeTracer&) = delete;
  EmbreeTracer& operator=(const EmbreeTracer&) = delete;

  /// Hands a block's rays to Embree 16 at a time.
  [[nodiscard]] Tracer tracer() const;
  /// The scene that it traces, for other ways of calling Embree.
  [[nodiscard]] RTCSceneTy* scene() const;

 private:
  EmbreeTracer() = default;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace penumbra
