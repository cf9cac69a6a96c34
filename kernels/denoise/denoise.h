// Runs one stage of denoising for one tile.
#ifndef PENUMBRA_DENOISE_H
#define PENUMBRA_DENOISE_H
#include "kernels/denoise/regression_tile.h"

PENUMBRA_NAMESPACE_BEGIN

FN int denoise_scratch_floats(const GLOBAL DenoiseTask* task) {
  return task->stage == DENOISE_FILTER ? filter_scratch_floats(task)
         : task->stage == DENOISE_FIT  ? fit_scratch_floats(task)
                                       : predict_scratch_floats(task);
}

/// `models` are written by DENOISE_FIT and read by DENOISE_PREDICT; `out` is written by the other two stages.
/// `scratch` has denoise_scratch_floats.
FN void denoise_tile_of(const GLOBAL DenoiseTask* task, int number, const GLOBAL float* guide,
                        const GLOBAL float* sources, GLOBAL float* models, GLOBAL float* scratch,
                        GLOBAL float* out) {
  if (task->stage == DENOISE_FILTER) filter_tile(task, number, guide, sources, scratch, out);
  if (task->stage == DENOISE_FIT) fit_tile(task, number, guide, sources, scratch, models);
  if (task->stage == DENOISE_PREDICT) predict_tile(task, number, guide, sources, models, scratch, out);
}

PENUMBRA_NAMESPACE_END
#endif
