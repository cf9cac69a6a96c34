// Other kinds of Embree calls than the workers', for comparison: single rays, and a whole block as a stream
// in place. For scenes of triangles only.
#pragma once

#include "kernels/host/native_kernels.h"
#include "worker/embree_tracer.h"

namespace penumbra {

Tracer embree_single(const EmbreeTracer& tracer);
Tracer embree_stream(const EmbreeTracer& tracer);

}  // namespace penumbra
