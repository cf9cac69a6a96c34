// Reads <volume> objects that are grids.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "scenes/mitsuba/plugin.h"
#include "scenes/volume_file.h"

namespace penumbra::mitsuba {

class VolumeReader {
 public:
  /// The grid of the `gridvolume` given for the parameter `name`. Each file is read only once. Nothing, and
  /// an error, if it cannot be read or contains an invalid value.
  std::optional<GridVolume> read(const Context& context, const Object& object, std::string_view name,
                                 const VolumeColour& values);

 private:
  using File = std::shared_ptr<const VolumeFile>;
  File open(const Context& context, PluginReader& plugin, const std::string& filename, bool has_border);
  static Expected<File> read_new(const FileAccess& files, const std::filesystem::path& path, bool has_border);

  std::map<std::pair<std::string, bool>, Expected<File>>
      files_;  ///< keyed by path, and whether with a border
};

}  // namespace penumbra::mitsuba
