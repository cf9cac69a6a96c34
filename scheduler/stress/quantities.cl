// The OpenCL entry point of the quantities: a question a work item.
#include "scheduler/stress/quantities.h"

__kernel void answer(__global const int* ids, __global const double* in, __global double* out,
                     __global uint* scratch) {
  const int i = (int)get_global_id(0);
  quantity(ids[i], in + i * QUANTITY_INPUTS, out + i * QUANTITY_OUTPUTS, scratch + i * QUANTITY_SCRATCH);
}
