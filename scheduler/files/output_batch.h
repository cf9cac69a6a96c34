// The files of one run, which appear together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/files/atomic_file.h"
#include "scheduler/files/file_target.h"

namespace penumbra {

/// Plain files are put in place all or none, and of two batches for the same files the one that ends last
/// wins whole: while they are renamed, their folders are locked (by flock, which leaves nothing behind).
/// Devices and pipes come after them.
class OutputBatch {
 public:
  /// Writes a plain file aside. What goes wrong is told at the end.
  void add(std::filesystem::path path, std::vector<std::uint8_t> bytes);

  /// Puts everything in its place. What could not be written is written to a new folder in TMPDIR, or /tmp,
  /// instead; the error says why, and where it is.
  Expected<void> finish();

 private:
  struct Entry {
    std::filesystem::path path;
    std::vector<std::uint8_t> bytes;
    FileTarget target;
    std::optional<StagedFile> staged;
    bool written = false;
  };
  void complain(const Error& error);
  void put_in_place();
  void write_directly();
  [[nodiscard]] std::string rescue();

  std::vector<Entry> entries_;
  std::string errors_;  ///< a line each
};

}  // namespace penumbra
