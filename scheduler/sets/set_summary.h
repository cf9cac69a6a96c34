// The results of the renders of a set, in a file and on the terminal.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// kNotBegun: the set was stopped before.
enum class SetState { kWaiting, kDone, kUnchanged, kIncomplete, kFailed, kNotBegun };

struct SetEntry {
  std::string name;                                          ///< for display
  std::string scene;                                         ///< scene file
  std::vector<std::pair<std::string, std::string>> choices;  ///< its parameters except the scene
  SetState state = SetState::kWaiting;
  std::vector<std::string> files;  ///< absolute paths of the files that it has or will have
  std::vector<std::string> remade =
      {};                       ///< those of them that, where they are missing, are made of the others
  std::string key;              ///< hash of everything on which the images depend; empty: unknown
  std::string error;            ///< why it failed or is incomplete
  double seconds = 0;           ///< render time
  std::uint64_t samples = 0;    ///< samples per pixel
  std::uint64_t budget_of = 0;  ///< if the time budget ended it: the samples per pixel asked for; else 0
  double relative_error = 0;    ///< of the image; see FilmAccumulator; NaN: unknown
};

/// "done", "unchanged", ...
std::string_view set_state_name(SetState state);

/// Writes all entries atomically, and keeps those of other sets that have ended, such as other frames of a
/// shot which other processes render.
Expected<void> write_set_summary(const std::filesystem::path& path, const std::vector<SetEntry>& entries);

/// The entries as CSV with a header: name, scene, a column for each parameter that any of them has, state,
/// samples per pixel, render time, relative error, first file, and the reason of those that are not done.
std::string set_table(const std::vector<SetEntry>& entries);

/// All entries of a summary, first those of the set that wrote it last. Empty if it cannot be read.
std::vector<SetEntry> read_set_summary(const std::filesystem::path& path);

/// Renders that an earlier summary lists with a key and whose files all exist or are remade. Empty if there
/// is no readable summary.
class EarlierRenders {
 public:
  static EarlierRenders read(const std::filesystem::path& path);

  /// Removes and returns the entry with these files. Nothing if there is none.
  std::optional<SetEntry> take(const std::vector<std::string>& files);
  /// The entries that were not taken.
  [[nodiscard]] std::vector<SetEntry> rest() &&;

 private:
  std::map<std::vector<std::string>, SetEntry> entries_;  ///< keyed by files
};

/// One line about an entry that has ended, with its end: "14:03:27   3 of 24  NAME  done …". `ended` counts
/// it and those before it; `widest` is the length of the longest name.
std::string set_line(const SetEntry& entry, std::size_t ended, std::size_t all, std::size_t widest);
/// The last line: how many renders ended how.
std::string set_totals(const std::vector<SetEntry>& entries, double seconds);

}  // namespace penumbra
