// What became of each render of a set, on disk and on the terminal.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

enum class SetState { kWaiting, kDone, kUnchanged, kIncomplete, kFailed };

struct SetEntry {
  std::string name;                                          ///< for people
  std::string scene;                                         ///< its file
  std::vector<std::pair<std::string, std::string>> choices;  ///< what else it was given
  SetState state = SetState::kWaiting;
  std::vector<std::string> files;  ///< written or there, absolute
  std::string key;                 ///< hash of all that the images in the files depend on; empty: not known
  std::string error;               ///< why it failed or is incomplete
  double seconds = 0;              ///< of rendering
  std::uint64_t samples = 0;       ///< of a pixel
  double relative_error = 0;       ///< of the image, see FilmAccumulator; NaN: not known
};

/// "done", "unchanged", ...
std::string_view set_state_name(SetState state);

/// Writes all entries, whole or not at all; and those of `earlier` sets that are no part of this one.
Expected<void> write_set_summary(const std::filesystem::path& path, const std::vector<SetEntry>& entries,
                                 const std::vector<SetEntry>& earlier = {});

/// Renders that an earlier summary knows the keys of, and whose files are all there; none if there is no
/// summary, or none that can be read.
class FinishedRenders {
 public:
  static FinishedRenders read(const std::filesystem::path& path);

  /// What is in these files, which is taken out; nothing if that is not known.
  std::optional<SetEntry> take(const std::vector<std::string>& files);
  /// What has not been taken.
  [[nodiscard]] std::vector<SetEntry> rest() &&;

 private:
  std::map<std::vector<std::string>, SetEntry> entries_;  ///< by their files
};

/// One line for each.
std::string set_table(const std::vector<SetEntry>& entries);

}  // namespace penumbra
