// What a client shows to a service to prove that jobs are its own.
#pragma once

#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// The secret of this user, which is made at the first call: XDG_STATE_HOME/penumbra/submitter, readable for
/// the user alone. It belongs to the home folder, so that it is the same on all hosts that share that. Every
/// service is shown the same one: whoever runs one could change this user's jobs on others. Errors: it can be
/// neither read nor made; the file is not one that this has made. Then the user has no jobs of its own.
Expected<std::string> submitter_secret();

}  // namespace penumbra
