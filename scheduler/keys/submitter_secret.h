// What a client shows to a service to prove that jobs are its own.
#pragma once

#include <string>

namespace penumbra {

/// The secret of this user, which is made at the first call: XDG_STATE_HOME/penumbra/submitter, readable for the
/// user alone. It belongs to the home folder, so that it is the same on all hosts that share that. Empty if
/// it can be neither read nor made; then the user has no jobs of its own.
std::string submitter_secret();

}  // namespace penumbra
