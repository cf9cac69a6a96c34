// How a device lays out what it shares with the host, for a test: apart from the kernels that render, so that
// they compile sooner.
#include "kernels/scene_types.h"

/// The size and then the field offsets of every shared struct as this device lays them out, in the order of
/// SHARED_STRUCTS: for comparison with the host's.
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
