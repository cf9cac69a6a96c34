// What became of each render of a set, on disk and on the terminal.
#pragma once

#include <filesystem>
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

/// Writes all entries, whole or not at all.
Expected<void> write_set_summary(const std::filesystem::path& path, const std::vector<SetEntry>& entries);

/// Renders that an earlier summary knows the keys of, and whose files are all there; none if there is no
/// summary, or none that can be read.
class FinishedRenders {
 public:
  static FinishedRenders read(const std::filesystem::path& path);

  /// What is in these files; null if that is not known.
  [[nodiscard]] const SetEntry* find(const std::vector<std::string>& files) const;

 private:
  std::vector<SetEntry> entries_;
};

/// One line for each.
std::string set_table(const std::vector<SetEntry>& entries);

}  // namespace penumbra
