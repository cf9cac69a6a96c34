// `penumbra keys`: makes an authority for a farm, and a certificate and tokens for each role.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

struct MakeKeysOptions {
  std::filesystem::path folder;    ///< is created, accessible only to its owner
  std::vector<std::string> names;  ///< host names and addresses at which clients reach the scheduler
  int days = 730;                  ///< validity of the certificates; the authority's is twice as long
  bool force = false;              ///< replaces existing files
};

/// key_folder.h describes the files. Every file is created with mode 0600. Errors: files exist already
/// (nothing is written then), an invalid name, a full disk.
Expected<void> make_keys(const MakeKeysOptions& options);

}  // namespace penumbra
