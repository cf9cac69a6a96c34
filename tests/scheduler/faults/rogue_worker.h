// A worker that speaks the protocol and does something wrong with one of its units. It runs in the test's
// process and has no renderer, but its connection is real.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "penumbra.grpc.pb.h"
#include "worker/protocol/unit_result.h"

namespace penumbra {

enum class Roguery {
  kNone,
  kSlow,           ///< takes 20 times as long for each unit
  kFlippedBit,     ///< of the values, behind their checksum
  kWrongChecksum,  ///< of the right values
  kWrongUnit,      ///< names another unit than it was given
  kNaN,            ///< among the values, with the right checksum
  kShort,          ///< values of one pixel too few
  kTwice,          ///< sends the result a second time
  kLies,           ///< other values, with the right checksum, and from then on
  kFails,          ///< reports that it cannot do units, three in a row
  kFalls,          ///< silent: neither results nor signs of life any more
  kLeaves,         ///< breaks its connection with a unit in hand
  kTalksNonsense,  ///< sends a message that means nothing
  kCount
};
const char* text_of(Roguery roguery);

struct RogueHabit {
  Roguery roguery = Roguery::kNone;
  int at = 1;  ///< in its so many-th unit
  std::chrono::milliseconds delay{5};
};

class RogueWorker {
 public:
  /// Connects as soon as somebody listens at the address, and works until it is sent away or this goes.
  /// `layers`: of the results of the job.
  RogueWorker(std::string address, RogueHabit habit, const FilmLayers& layers);
  RogueWorker(const RogueWorker&) = delete;
  RogueWorker& operator=(const RogueWorker&) = delete;
  ~RogueWorker();

  /// Whether it came to do what it is there for.
  [[nodiscard]] bool has_done_it() const { return done_it_; }

 private:
  using Stream = grpc::ClientReaderWriter<wire::WorkerMessage, wire::SchedulerMessage>;

  void run();
  void beat();
  bool say(const wire::WorkerMessage& message);
  bool answer(const wire::Unit& unit);
  bool do_it(wire::WorkerMessage& result, const wire::Unit& unit);

  const std::string address_;
  const RogueHabit habit_;
  const FilmLayers layers_;
  grpc::ClientContext context_;
  std::unique_ptr<Stream> stream_;
  std::mutex mutex_;  // of writing
  int units_ = 0, failures_left_ = 0;
  std::atomic<bool> done_it_ = false, silent_ = false, over_ = false;
  std::thread thread_;
};

}  // namespace penumbra
