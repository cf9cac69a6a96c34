// What is done with secrets wherever they are.
#pragma once

#include <string>
#include <string_view>

namespace penumbra {

/// 128 random bits as 32 hexadecimal digits.
std::string make_token();

/// In a time that depends on the lengths alone, and not on where they differ.
bool are_equal_secrets(std::string_view a, std::string_view b);

/// From here on a crash of this process leaves no core, and processes of other users, or debuggers of this
/// one, do not read its memory (PR_SET_DUMPABLE). Marking pages (MADV_DONTDUMP) would not do: gRPC and
/// OpenSSL copy keys and tokens into buffers of their own. Children that execute a program are as usual
/// again.
void keep_out_of_core_dumps();

}  // namespace penumbra
