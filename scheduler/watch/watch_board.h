// The visible state of a render. The one thread that drives the render shares it with any number of viewers.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "kernels/host/view.h"
#include "scheduler/plan/tile_snapshot.h"

namespace penumbra {

/// The properties that do not change during the render.
struct WatchedJob {
  std::uint32_t id = 0;
  std::string title;  ///< the scene file, for display
  std::string integrator;
  int film_width = 0, film_height = 0;
  int x = 0, y = 0, width = 0, height = 0;  ///< film rectangle that is rendered
  std::uint32_t spp = 0;                    ///< the largest number of samples per pixel
  std::string scene_hash;  ///< content hash of the device scene, with which it can be fetched as an asset
  /// The scene's centre in world space, to which the device scene's positions are relative.
  double center[3] = {0, 0, 0};
  bool interactive = false;              ///< viewers determine camera and samples
  bool hybrid = false;                   ///< tiles contain a difference to the closed form
  std::string command = {};              ///< the `penumbra render` command of the job, without a view
  std::uint32_t scene_spp = 0;           ///< samples per pixel that the scene asks for
  std::vector<std::string> layers = {};  ///< further layers that its tiles can contain
};

struct WatchView {
  std::uint32_t number = 0;
  View view{};
};

struct WatchedWorker {
  std::uint32_t number = 0;
  std::string name, device;
  std::uint64_t units = 0;
  std::uint32_t job = 0;                    ///< the job of its current unit
  int x = 0, y = 0, width = 0, height = 0;  ///< film pixels of its current unit; width 0: none
  bool operator==(const WatchedWorker&) const = default;
};

struct WatchProgress {
  std::uint32_t view = 0;
  std::uint64_t samples_done = 0, samples_wanted = 0;  ///< over all pixels
  std::uint32_t spp_done = 0, spp_wanted = 0;          ///< samples per pixel
  double elapsed_seconds = 0;                          ///< time spent rendering samples of this view
  double relative_error = std::numeric_limits<double>::quiet_NaN();
  bool finished = false;  ///< everything requested is merged
  bool ended = false;     ///< the render is over
  std::vector<WatchedWorker> workers;
};

/// In the order in which a viewer must receive them.
using WatchItem = std::variant<WatchView, std::string, std::shared_ptr<const WatchProgress>,
                               std::shared_ptr<const TileSnapshot>>;

/// Holds the newest state of a render. Each viewer reads what it has not seen at its own speed; of several
/// changes it gets only the newest. A slow viewer delays no one else and costs no additional memory.
/// Thread-safe.
class WatchBoard {
 public:
  explicit WatchBoard(std::uint32_t tiles) : tiles_(tiles) {}

  // --- For the render

  void describe(WatchedJob job);
  /// Sets another camera view; tiles and progress of the previous one are discarded.
  void show_view(const WatchView& view);
  void show_tile(std::uint32_t tile, TileSnapshot snapshot);
  void show_progress(WatchProgress progress);
  void say(std::string message);
  /// Whether there are viewers. Without viewers no tiles are stored, so none need be published.
  [[nodiscard]] bool is_watched() const;
  /// Returns true once after a viewer has joined while no tiles were stored: then all tiles must be published
  /// again.
  [[nodiscard]] bool take_request_for_all_tiles();
  /// The further layers that tiles are to contain.
  [[nodiscard]] std::set<std::string> wanted_layers() const;
  /// No more changes will come.
  void close();
  /// Waits until every viewer has seen everything or has gone, or until no viewer has read anything for
  /// `patience`.
  void wait_for_watchers(std::chrono::milliseconds patience);

  // --- For a viewer

  /// From now on tiles contain these layers too, until the last viewer has gone. All tiles are requested
  /// again.
  void want_layers(const std::vector<std::string>& names);

  class Watcher {
   public:
    explicit Watcher(WatchBoard& board);
    Watcher(const Watcher&) = delete;
    Watcher& operator=(const Watcher&) = delete;
    ~Watcher();

    /// The job, once it is set; nothing if that does not happen within `patience`.
    std::optional<WatchedJob> job(std::chrono::milliseconds patience);
    /// The next item that the viewer has not seen, waiting at most `patience`.
    std::optional<WatchItem> next(std::chrono::milliseconds patience);
    /// Whether the board is closed and the viewer has seen everything.
    [[nodiscard]] bool at_end() const;

   private:
    friend class WatchBoard;
    std::optional<WatchItem> take();
    [[nodiscard]] bool has_seen_all() const { return seen_ == board_.version_; }

    WatchBoard& board_;
    std::uint64_t seen_ = 0;  // the version of the board at which this viewer had seen everything
    std::uint64_t seen_view_ = 0, seen_progress_ = 0, seen_messages_ = 0;
    std::vector<std::uint64_t> seen_tiles_;
    // Where the search for unseen tiles begins, so that no tile waits behind others that change more often.
    std::size_t next_tile_ = 0;
  };

 private:
  struct Tile {
    std::uint64_t version = 0;
    std::shared_ptr<const TileSnapshot> snapshot;
  };

  mutable std::mutex mutex_;
  std::condition_variable changed_, seen_;
  std::optional<WatchedJob> job_;
  std::uint64_t version_ = 0;  // incremented by every change
  std::uint64_t view_version_ = 0, progress_version_ = 0;
  WatchView view_;
  std::shared_ptr<const WatchProgress> progress_;
  std::vector<Tile> tiles_;
  std::deque<std::string> messages_;  // the most recent ones
  std::uint64_t messages_said_ = 0;
  std::vector<Watcher*> watchers_;
  std::uint64_t items_taken_ = 0;
  std::set<std::string> wanted_layers_;
  bool all_tiles_requested_ = false, closed_ = false;
};

}  // namespace penumbra
