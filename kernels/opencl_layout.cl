// Reports a device's layout of shared structs, for a test. It is not in opencl.cl, so that both compile
// sooner.
#include "kernels/scene_types.h"

/// Writes the size and then the field offsets of every shared struct on this device, in the order of
/// SHARED_STRUCTS, for comparison with the host's.
__kernel void report_layout(__global uint* out) {
  int n = 0;
#define REPORT_FIELD(type, name) out[n++] = (uint)(size_t) & (object->name);
#define REPORT_STRUCT(name, fields)  \
  {                                  \
    __global const name* object = 0; \
    out[n++] = (uint)sizeof(name);   \
    fields(REPORT_FIELD)             \
  }
  SHARED_STRUCTS(REPORT_STRUCT)
#undef REPORT_STRUCT
#undef REPORT_FIELD
}
