// Writes the files of one run so that they appear together.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/atomic_file.h"
#include "kernels/host/error.h"
#include "kernels/host/file_target.h"

namespace penumbra {

/// Regular files are all put in place, or none. If two batches write the same files, the one that ends last
/// wins completely: their folders are locked while files are renamed (by flock, which leaves nothing behind).
/// Devices and pipes are written afterwards.
class OutputBatch {
 public:
  using Bytes = std::vector<std::uint8_t>;

  /// Writes a temporary file. Errors are reported by finish(), in the order of the files.
  void add(std::filesystem::path path, Bytes bytes);
  /// The same on another thread, which calls `make` for the bytes. What `make` reads must stay valid until
  /// wait(), finish() or the destructor. A file that cannot be made is an error like the others.
  void add_aside(std::filesystem::path path, std::function<Expected<Bytes>()> make);
  /// Waits until all temporary files are written.
  void wait();

  /// Puts all files in place. Files that cannot be written there are written to a new folder in TMPDIR, or
  /// /tmp, instead; the error says why, and where they are.
  Expected<void> finish();

 private:
  struct Entry {
    std::filesystem::path path;
    Bytes bytes;
    FileTarget target;
    std::optional<StagedFile> staged;
    bool made = true, written = false;
    std::string error;         // of making the bytes, or of writing the temporary file
    std::future<void> making;  // the last member, so that it is waited for before the others are destroyed

    void write_aside();
    void make_and_write_aside(const std::function<Expected<Bytes>()>& make);
  };
  void complain(const std::string& text);
  void put_in_place();
  void write_directly();
  [[nodiscard]] std::string rescue();

  std::deque<Entry> entries_;  // a deque, so that addresses stay valid
  std::string errors_;         ///< one per line
};

}  // namespace penumbra
