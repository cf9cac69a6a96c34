// The files of one run, which appear together.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <future>
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
  using Bytes = std::vector<std::uint8_t>;

  /// Writes a plain file aside. What goes wrong is told at the end, in the order of the files.
  void add(std::filesystem::path path, Bytes bytes);
  /// The same on a thread of its own, where `make` is called for the bytes: what that reads stays until
  /// wait(), finish() or the end of the batch. A file that cannot be made is an error like the others.
  void add_aside(std::filesystem::path path, std::function<Expected<Bytes>()> make);
  /// Waits until all of them are written aside.
  void wait();

  /// Puts everything in its place. What could not be written is written to a new folder in TMPDIR, or /tmp,
  /// instead; the error says why, and where it is.
  Expected<void> finish();

 private:
  struct Entry {
    std::filesystem::path path;
    Bytes bytes;
    FileTarget target;
    std::optional<StagedFile> staged;
    bool made = true, written = false;
    std::string error;         // of the bytes, or of writing them aside
    std::future<void> making;  // the last member: it is waited for before the others go

    void write_aside();
    void make_and_write_aside(const std::function<Expected<Bytes>()>& make);
  };
  void complain(const std::string& text);
  void put_in_place();
  void write_directly();
  [[nodiscard]] std::string rescue();

  std::deque<Entry> entries_;  // which stay where they are
  std::string errors_;         ///< a line each
};

}  // namespace penumbra
