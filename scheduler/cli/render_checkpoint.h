// What a render depends on, and the checkpoint that it keeps and goes on with.
#pragma once

#include <string>

#include "kernels/host/error.h"
#include "scheduler/checkpoint/checkpoint.h"
#include "scheduler/cli/render_preparation.h"

namespace penumbra {

/// All that its samples depend on; `worker` is the hash of that program. The scene goes by its name without
/// the folder, as in the image's metadata.
RenderIdentity identity_of(const PreparedRender& prepared, const std::string& worker);

/// Gives the render its checkpoint, beside its first file, whose folder is there; and what an earlier process
/// has left in it, but for `options.restart`. Returns what is to be said of that, a line or nothing. Errors:
/// the checkpoint is of another render (with what differs), damaged, unreadable.
Expected<std::string> attach_checkpoint(PreparedRender& prepared, const RenderOptions& options,
                                        const std::string& worker);

/// Native code is to render what the machine's own choice of a device could not; what the farm that has
/// failed has used up of a checkpoint is read again.
Expected<void> fall_back_to_native(PreparedRender& prepared);

/// The render is complete and its files are there.
void remove_checkpoint(PreparedRender& prepared);

}  // namespace penumbra
