// The tokens of a scheduler. A call over TCP must present one, which determines what it may do.
#pragma once

#include <array>
#include <string>

namespace penumbra {

/// The tokens for TCP. That of a viewer does not permit sending samples.
struct Tokens {
  std::string watch = {};   ///< permits Watch, Control, and fetching the data for them
  std::string work = {};    ///< permits Work, and fetching the data for it
  std::string submit = {};  ///< permits all other calls, and everything that `watch` permits
};

/// For loops over all kinds of tokens.
struct TokenKind {
  const char* name;
  const char* what_for;
  std::string Tokens::*token;
};
inline constexpr std::array<TokenKind, 3> kTokenKinds{{{"watch", "watching", &Tokens::watch},
                                                       {"work", "workers", &Tokens::work},
                                                       {"submit", "submitting", &Tokens::submit}}};

}  // namespace penumbra
