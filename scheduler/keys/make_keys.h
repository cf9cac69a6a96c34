// `penumbra keys`: an authority of a farm's own, a certificate and tokens for each role.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

struct MakeKeysOptions {
  std::filesystem::path folder;    ///< is made, for its owner alone
  std::vector<std::string> names;  ///< host names and addresses at which clients reach the scheduler
  int days = 730;                  ///< of the certificates; the authority's is twice as long
  bool force = false;              ///< replaces what is there
};

/// What is in the files and where is in key_folder.h. Every file is its owner's alone from the moment that it
/// is there (mode 0600). Errors: anything is there already (nothing is written then), a name that is none, a
/// full disk.
Expected<void> make_keys(const MakeKeysOptions& options);

}  // namespace penumbra
