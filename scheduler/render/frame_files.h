// The names of a shot's files, with a field for the number of the frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

class FrameFiles {
 public:
  /// Of a path with a field: "out/shot.####.exr" (as many digits as there are #, or more), "{frame:04}",
  /// "{frame}", or as for printf "%04d", "%d". Where there are several the last one counts. Nothing if there
  /// is none.
  static std::optional<FrameFiles> of(std::string_view name);

  /// The same; nothing where a file has that very name, which is then one image.
  static std::optional<FrameFiles> unless_file(const std::string& name);

  [[nodiscard]] std::filesystem::path file(int frame) const;
  /// The frame of a file of this shot; nothing for others. Only the text of the path counts.
  [[nodiscard]] std::optional<int> frame_of(const std::filesystem::path& file) const;
  /// The frames of all files that exist, ascending. The field may be in the name of a folder.
  [[nodiscard]] std::vector<int> find() const;

  /// The folder in whose entries the number is.
  [[nodiscard]] std::filesystem::path folder() const;
  /// The path without the field and the separator before it: "out/shot.exr".
  [[nodiscard]] std::filesystem::path without_field() const;

 private:
  FrameFiles(std::string before, std::string after, std::size_t digits)
      : before_(std::move(before)), after_(std::move(after)), digits_(digits) {}

  std::string before_, after_;
  std::size_t digits_;  // at least
};

/// A name with the fields {frame}, {frame:0N} replaced by as many #.
std::string with_hashes(std::string name);

}  // namespace penumbra
