// Reads the meshes of a scene on all cores while the scene is read, in whatever order its reader asks for
// them.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/file_access.h"
#include "scenes/mesh_reader.h"

namespace penumbra {

struct MeshRequest {
  enum class Format { kObj, kPly };
  std::filesystem::path file;
  Format format = Format::kObj;
  MeshAttributeNames attributes = {};
};

/// Only a guess at what will be asked for: read() always gives what read_obj or read_ply gives for the file's
/// text, but without the places of odd faces. A file that is requested several times is parsed once.
class MeshesAhead {
 public:
  /// Meshes that nobody has asked for yet hold at most this many bytes of text, and one file per thread more.
  static constexpr std::size_t kMostBytes = std::size_t(512) << 20;

  /// `requests` in the order in which they will be asked for. `helpers`: threads beside the caller's.
  MeshesAhead(const std::vector<MeshRequest>& requests, const FileAccess& files, unsigned helpers,
              std::size_t most_bytes = kMostBytes);
  ~MeshesAhead();
  MeshesAhead(const MeshesAhead&) = delete;
  MeshesAhead& operator=(const MeshesAhead&) = delete;

  /// The mesh of the file, whose text may have changed since it was read ahead. For one thread.
  Expected<MeshFile> read(const MeshRequest& request, const SourceFile& file);

 private:
  enum class State { kWaiting, kReading, kRead };
  using Digest = std::pair<std::uint64_t, std::uint64_t>;
  struct Slot {
    MeshRequest request;
    int uses = 0;  ///< how often it will still be asked for
    State state = State::kWaiting;
    Digest text = {};
    std::size_t bytes = 0;  ///< of the text
    std::optional<Expected<MeshFile>> mesh = {};
  };
  using Key = std::tuple<std::filesystem::path, MeshRequest::Format, std::string, std::string>;

  static Key key_of(const MeshRequest& request);
  void help(const FileAccess& files);
  bool read_next(const FileAccess& files, std::unique_lock<std::mutex>& lock);
  void store(Slot& slot, const SourceFile& file, Expected<MeshFile> mesh);

  const std::size_t most_bytes_;
  const FileAccess files_;  ///< the caller's
  std::list<Slot> slots_;
  std::map<Key, Slot*> by_key_;
  std::mutex mutex_;  ///< guards the slots' contents and all below
  std::condition_variable changed_;
  std::list<Slot>::iterator next_;  ///< the slots before it have been taken
  std::size_t held_bytes_ = 0;
  bool stops_ = false;
  std::vector<std::thread> helpers_;
};

}  // namespace penumbra
