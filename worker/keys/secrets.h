// Secrets: random tokens, and that of the user.
#pragma once

#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

/// A random token: 128 bits as 32 hexadecimal digits.
std::string make_token();

/// Compares in a time that depends only on the lengths, not on where the texts differ.
bool are_equal_secrets(std::string_view a, std::string_view b);

/// From now on a crash of this process writes no core dump, and processes of other users and debuggers of
/// this one cannot read its memory (PR_SET_DUMPABLE). Marking pages (MADV_DONTDUMP) would not suffice,
/// because gRPC and OpenSSL copy keys and tokens into their own buffers. Children that execute a program are
/// not affected.
void keep_out_of_core_dumps();

/// The secret of this user, which is made at the first call: XDG_STATE_HOME/penumbra/submitter, readable for
/// the user alone. It belongs to the home folder, so that it is the same on all hosts that share that. Every
/// service is shown the same one: whoever runs one could change this user's jobs on others. Errors: it can be
/// neither read nor made; the file is not one that this has made. Then the user has no jobs of its own.
Expected<std::string> submitter_secret();

}  // namespace penumbra
