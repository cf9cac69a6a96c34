// The visible state of a render, shared by the one thread that drives it and any number of watchers.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kernels/host/view.h"
#include "scheduler/watch/tile_snapshot.h"

namespace penumbra {

/// What does not change while the render goes on.
struct WatchedJob {
  std::uint32_t id = 0;
  std::string title;  ///< the scene file, for people
  std::string integrator;
  int film_width = 0, film_height = 0;
  int x = 0, y = 0, width = 0, height = 0;  ///< film rectangle that is rendered
  std::uint32_t spp = 0;                    ///< samples of a pixel at most
  std::string scene_hash;                   ///< the device scene as an asset
  double center[3] = {0, 0, 0};  ///< of the scene in world space: what the device scene is relative to
  bool interactive = false;      ///< camera and samples are as watchers want
  bool hybrid = false;           ///< tiles have a difference to the closed form
};

struct WatchView {
  std::uint32_t number = 0;
  View view{};
};

struct WatchedWorker {
  std::uint32_t number = 0;
  std::string name, device;
  std::uint64_t units = 0;
  std::uint32_t job = 0;                    ///< that it works at
  int x = 0, y = 0, width = 0, height = 0;  ///< film pixels in hand; no width: none
};

struct WatchProgress {
  std::uint32_t view = 0;
  std::uint64_t samples_done = 0, samples_wanted = 0;  ///< over all pixels
  std::uint32_t spp_done = 0, spp_wanted = 0;          ///< in every pixel
  double elapsed_seconds = 0;                          ///< of rendering samples of this view
  double relative_error = std::numeric_limits<double>::quiet_NaN();
  bool finished = false;  ///< all that is wanted is merged
  bool ended = false;     ///< the render is over
  std::vector<WatchedWorker> workers;
};

/// In the order in which a watcher needs to know of them.
using WatchItem = std::variant<WatchView, std::string, std::shared_ptr<const WatchProgress>,
                               std::shared_ptr<const TileSnapshot>>;

/// Holds the newest state of everything. Each watcher takes what it has not seen at its own speed; of several
/// changes it gets only the newest. A slow watcher delays no one else and costs no memory. Thread-safe.
class WatchBoard {
 public:
  explicit WatchBoard(std::uint32_t tiles) : tiles_(tiles) {}

  // --- The render's side

  void describe(WatchedJob job);
  /// Another camera: tiles and progress of the last one are forgotten.
  void show_view(const WatchView& view);
  void show_tile(std::uint32_t tile, TileSnapshot snapshot);
  void show_progress(WatchProgress progress);
  void say(std::string message);
  /// Without watchers no tiles are kept, and none need be shown.
  [[nodiscard]] bool is_watched() const;
  /// True once after a watcher has joined while there were no tiles: all tiles must be shown again.
  [[nodiscard]] bool take_request_for_all_tiles();
  /// Nothing more will come.
  void close();
  /// Waits until every watcher has seen everything or has gone, but no longer than this while nothing moves.
  void wait_for_watchers(std::chrono::milliseconds patience);

  // --- A watcher's side

  class Watcher {
   public:
    explicit Watcher(WatchBoard& board);
    Watcher(const Watcher&) = delete;
    Watcher& operator=(const Watcher&) = delete;
    ~Watcher();

    /// The job, once it is described; nothing if that does not happen within `patience`.
    std::optional<WatchedJob> job(std::chrono::milliseconds patience);
    /// What it has not seen, waiting for it at most so long.
    std::optional<WatchItem> next(std::chrono::milliseconds patience);
    /// Nothing more will come, and it has seen everything.
    [[nodiscard]] bool at_end() const;

   private:
    friend class WatchBoard;
    std::optional<WatchItem> take();
    [[nodiscard]] bool has_seen_all() const { return seen_ == board_.version_; }

    WatchBoard& board_;
    std::uint64_t seen_ = 0;  // the version of the board at which nothing was left to see
    std::uint64_t seen_view_ = 0, seen_progress_ = 0, seen_messages_ = 0;
    std::vector<std::uint64_t> seen_tiles_;
    std::size_t next_tile_ = 0;  // where to look first: no tile waits for ever behind busier ones
  };

 private:
  struct Tile {
    std::uint64_t version = 0;
    std::shared_ptr<const TileSnapshot> snapshot;
  };

  mutable std::mutex mutex_;
  std::condition_variable changed_, seen_;
  std::optional<WatchedJob> job_;
  std::uint64_t version_ = 0;  // of all; every change gets the next
  std::uint64_t view_version_ = 0, progress_version_ = 0;
  WatchView view_;
  std::shared_ptr<const WatchProgress> progress_;
  std::vector<Tile> tiles_;
  std::deque<std::string> messages_;  // the last ones
  std::uint64_t messages_said_ = 0;
  std::vector<Watcher*> watchers_;
  std::uint64_t items_taken_ = 0;
  bool all_tiles_requested_ = false, closed_ = false;
};

}  // namespace penumbra
