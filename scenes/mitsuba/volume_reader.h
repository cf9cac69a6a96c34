// <volume> objects that are grids.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "scenes/mitsuba/plugin.h"
#include "scenes/volume_file.h"

namespace penumbra::mitsuba {

class VolumeReader {
 public:
  /// The grid of a `gridvolume`, which stands for the parameter `name`; files are read once each. Nothing,
  /// and an error, where it cannot be read, or has a number that is none of the values.
  std::optional<GridVolume> read(const Context& context, const Object& object, std::string_view name,
                                 const VolumeColour& values);

 private:
  using File = std::shared_ptr<const VolumeFile>;
  File open(const Context& context, PluginReader& plugin, const std::string& filename);
  static Expected<File> read_new(const FileAccess& files, const std::filesystem::path& path);

  std::map<std::string, Expected<File>> files_;  ///< by their paths
};

}  // namespace penumbra::mitsuba
