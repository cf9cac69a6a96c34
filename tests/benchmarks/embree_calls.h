// Other ways of handing rays to Embree than the workers', to compare them: one by one, and a whole block as a
// stream where it lies. Scenes of triangles alone.
#pragma once

#include "kernels/host/native_kernels.h"
#include "worker/embree_tracer.h"

namespace penumbra {

Tracer embree_single(const EmbreeTracer& tracer);
Tracer embree_stream(const EmbreeTracer& tracer);

}  // namespace penumbra
