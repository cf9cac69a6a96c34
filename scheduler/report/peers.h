// Images of other renderers, with their render times in the file names: FOLDER/NAME/SECONDS-seconds.exr.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

struct PeerImage {
  std::filesystem::path file;
  double seconds = 0;
};

/// Another renderer, or one configuration of it.
struct Peer {
  std::string name;
  std::vector<PeerImage> images;  ///< by ascending time
};

/// The time in a file name like "0.35-seconds.exr" or "004.25-seconds.exr". Nothing for any other name.
std::optional<double> peer_seconds(std::string_view file_name);

/// All peers in the folder, by name. Hidden files are ignored. Errors: the folder is missing or contains no
/// folder with images; a file has another name; a time occurs twice; an image cannot be read or has another
/// size.
Expected<std::vector<Peer>> find_peers(const std::filesystem::path& folder, int width, int height);

}  // namespace penumbra
