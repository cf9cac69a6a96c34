// Functions for handling secrets.
#pragma once

#include <string>
#include <string_view>

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

}  // namespace penumbra
