// The tokens of a scheduler: what a call over TCP has to show, and what it may then do.
#pragma once

#include <array>
#include <string>

namespace penumbra {

/// Over TCP; a viewer's does not permit sending samples.
struct Tokens {
  std::string watch = {};   ///< Watch, Control, and the data that they need
  std::string work = {};    ///< Work, and the data that it needs
  std::string submit = {};  ///< whatever else there is, and all that `watch` permits
};

/// For all that is done with each of them alike.
struct TokenKind {
  const char* name;
  const char* what_for;
  std::string Tokens::*token;
};
inline constexpr std::array<TokenKind, 3> kTokenKinds{{{"watch", "watching", &Tokens::watch},
                                                       {"work", "workers", &Tokens::work},
                                                       {"submit", "submitting", &Tokens::submit}}};

}  // namespace penumbra
