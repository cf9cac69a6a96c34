// Images of other renderers, made by whatever means: FOLDER/NAME/SECONDS-seconds.exr.
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

/// One renderer, or one setting of one.
struct Peer {
  std::string name;
  std::vector<PeerImage> images;  ///< by time
};

/// "0.35-seconds.exr" and "004.25-seconds.exr": the time; nothing for any other name.
std::optional<double> peer_seconds(std::string_view file_name);

/// All peers of the folder, by name. Hidden files are passed over. Errors: the folder is missing or holds no
/// folder with images, a file of another name, one time twice, an image that cannot be read or is not of this
/// size.
Expected<std::vector<Peer>> find_peers(const std::filesystem::path& folder, int width, int height);

}  // namespace penumbra
