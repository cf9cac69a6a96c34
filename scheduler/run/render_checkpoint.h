// Attaches a checkpoint to a render: computes its identity, resumes from an earlier checkpoint and writes new
// ones.
#pragma once

#include <string>

#include "kernels/host/error.h"
#include "scheduler/checkpoint/checkpoint.h"
#include "scheduler/run/render_preparation.h"

namespace penumbra {

/// Everything on which the render's samples depend. `worker` is the hash of the worker's executable. The
/// scene is named without its folder, as in the image's metadata.
RenderIdentity identity_of(const PreparedRender& prepared, const std::string& worker);

/// Gives the render a checkpoint file beside its first output file, whose folder must exist, and the state
/// that an earlier process has stored there, unless `options.restart` is set. Returns a line for the user, or
/// an empty text. Errors: the checkpoint is of another render (with the difference), damaged or unreadable.
Expected<std::string> attach_checkpoint(PreparedRender& prepared, const RenderOptions& options,
                                        const std::string& worker);

/// Prepares a second attempt with native code after the automatically chosen device has failed. The
/// checkpoint is read again, because the failed farm has consumed its state.
Expected<void> fall_back_to_native(PreparedRender& prepared);

/// For use when the render is complete and its output files are written.
void remove_checkpoint(PreparedRender& prepared);

}  // namespace penumbra
