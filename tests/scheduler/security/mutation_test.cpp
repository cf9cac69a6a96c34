// Mutated messages of every type: no reader crashes, and what a reader accepts is consistent.
// PENUMBRA_SECURITY_MUTATIONS is the number of messages of each type.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "scheduler/farm/worker_connection.h"
#include "scheduler/watch/watch_wire.h"
#include "tests/scheduler/security/mutation.h"
#include "tests/support/fake_samples.h"
#include "worker/protocol/grpc_log.h"
#include "worker/protocol/text.h"
#include "worker/protocol/unit_result.h"

namespace penumbra {
namespace {

const bool kQuiet = (route_grpc_log(), true);  // protobuf complains of each text that is not UTF-8

constexpr RenderUnit kUnit{.x = 8, .y = 4, .width = 4, .height = 3, .first_sample = 16, .sample_count = 8};
constexpr std::size_t kRoom = 1 << 20;
constexpr UnitId kId{.job = 1, .phase = 0, .pass = 2, .tile = 3};

int mutations() {
  const char* wanted = std::getenv("PENUMBRA_SECURITY_MUTATIONS");
  return wanted == nullptr ? 100'000 : std::atoi(wanted);
}

/// Feeds mutants of the seeds to the reader, which says whether it took one. Some of both have to occur, or
/// the mutations reach nothing.
template <typename Message>
void feed(const std::vector<Message>& seeds, const std::function<bool(const Message&)>& is_taken) {
  std::vector<std::string> texts;
  for (const Message& seed : seeds) texts.push_back(seed.SerializeAsString());
  Mutator mutator(texts, 1234);
  int parsed = 0, taken = 0;
  for (int i = 0; i < mutations(); ++i) {
    const std::string bytes = mutator.next();
    Message message;
    if (!message.ParseFromString(bytes)) continue;
    ++parsed;
    taken += is_taken(message) ? 1 : 0;
  }
  testing::Test::RecordProperty("parsed", parsed);
  testing::Test::RecordProperty("taken", taken);
  EXPECT_GT(parsed, mutations() / 20);
  EXPECT_GT(taken, 0);
  EXPECT_LT(taken, mutations());
}

wire::WorkerMessage result() {
  wire::WorkerMessage message;
  encode(kId, 0, *message.mutable_result()->mutable_id());
  encode(fake_samples(kUnit, kNoLayers), *message.mutable_result());
  message.mutable_result()->set_busy_seconds(0.5);
  message.mutable_result()->set_peak_memory_bytes(1 << 20);
  return message;
}

/// The same result in three messages.
std::vector<wire::WorkerMessage> parts() {
  const SampleBuffer buffer = fake_samples(kUnit, kNoLayers);
  wire::UnitId id;
  encode(kId, 0, id);
  ResultCutter cutter(id, buffer);
  std::vector<wire::WorkerMessage> messages(3);
  for (wire::WorkerMessage& message : messages) cutter.next(100, message);
  return messages;
}

std::vector<wire::WorkerMessage> worker_messages() {
  std::vector<wire::WorkerMessage> all(8);
  all[0].mutable_hello()->set_protocol_version(kProtocolVersion);
  all[0].mutable_hello()->set_host("node7");
  all[0].mutable_hello()->set_key("0123456789abcdef");
  all[0].mutable_hello()->add_isas(wire::ISA_AVX2);
  all[1].mutable_ready()->set_job(1);
  all[1].mutable_ready()->set_device("native");
  all[1].mutable_ready()->mutable_kernels()->set_seconds(1.5);
  all[1].mutable_ready()->add_warnings("slow");
  all[2].mutable_job_failed()->set_job(1);
  all[2].mutable_job_failed()->set_message("no such device");
  all[3] = result();
  encode(kId, 0, *all[4].mutable_unit_failed()->mutable_id());
  all[4].mutable_unit_failed()->set_message("failed");
  all[5].mutable_compiling()->set_job(1);
  all[5].mutable_compiling()->set_device("an abacus");
  all[6].mutable_beat()->set_parts(77);
  all[7] = parts().front();
  return all;
}

void expect_text(const std::string& text, std::size_t longest) {
  EXPECT_LE(text.size(), longest);
  EXPECT_EQ(text, wire_text(text, longest)) << "UTF-8";
}

/// What the plan and the merge may rely on.
struct Checked {
  void operator()(const arrivals::Connected& a) const { expect_text(a.host, kLongestName); }
  void operator()(const arrivals::Compiling& a) const { expect_text(a.device, kLongestName); }
  void operator()(const arrivals::Ready& a) const {
    expect_text(a.device, kLongestName);
    EXPECT_LE(a.preparation.warnings.size(), std::size_t(kMostWarnings));
    if (a.preparation.kernels) EXPECT_GE(a.preparation.kernels->seconds, 0);
  }
  void operator()(const arrivals::Beat&) const {}
  void operator()(const arrivals::JobFailed& a) const { expect_text(a.message, kLongestText); }
  void operator()(const arrivals::Result& a) const {
    EXPECT_EQ(a.unit, kId) << "nothing else was asked for";
    EXPECT_EQ(a.buffer.values.size(), a.buffer.pixels() * std::size_t(kRadiancePlanes));
    EXPECT_TRUE(std::isfinite(a.busy_seconds));
    for (const float value : a.buffer.values) EXPECT_TRUE(std::isfinite(value));
  }
  void operator()(const arrivals::BadResult& a) const { EXPECT_FALSE(a.why.empty()); }
  void operator()(const arrivals::UnitFailed& a) const { expect_text(a.message, kLongestText); }
  void operator()(const auto&) const {}
};

TEST(Mutation, WhatWorkersSay) {
  const auto seeds = worker_messages();
  for (std::size_t one = 1; one <= seeds.size(); ++one) {
    // Of each kind as many as of each other, and of all mixed.
    const auto wanted = one < seeds.size() ? std::vector{seeds[one]} : seeds;
    feed<wire::WorkerMessage>(wanted, [](const wire::WorkerMessage& message) {
      ResultRoom room(kRoom);
      WorkerConnection connection(7, room);
      connection.send_job(1, "scene", {});
      connection.send_unit(kId, kUnit, kNoLayers);
      const auto understood = connection.understand(message);
      if (!understood) return false;
      const auto* arrival = std::get_if<Arrival>(&*understood);
      if (arrival != nullptr) std::visit(Checked{}, *arrival);
      return arrival != nullptr && !std::holds_alternative<arrivals::BadResult>(*arrival);
    });
  }
}

TEST(Mutation, PartsAreTheUnitsOwnResultOrRefusedWhateverTheirOrder) {
  std::vector<std::string> seeds;
  for (const wire::WorkerMessage& part : parts()) seeds.push_back(part.SerializeAsString());
  Mutator mutator(seeds, 1234);
  std::mt19937 random(99);
  const auto one_in = [&](std::uint32_t n) { return random() % n == 0; };
  const std::vector<float> values = fake_samples(kUnit, kNoLayers).values;
  int results = 0, refusals = 0;
  for (int i = 0; i < mutations(); ++i) {
    ResultRoom room(kRoom);
    WorkerConnection connection(7, room);
    connection.send_unit(kId, kUnit, kNoLayers);
    std::vector<std::string> said = seeds;
    if (one_in(4)) std::ranges::shuffle(said, random);
    if (one_in(4)) said.insert(said.begin() + random() % 3, seeds[random() % 3]);
    if (one_in(4)) said.erase(said.begin() + random() % 3);
    if (one_in(2)) said[random() % said.size()] = mutator.next();
    for (const std::string& bytes : said) {
      wire::WorkerMessage message;
      if (!message.ParseFromString(bytes)) continue;
      const auto understood = connection.understand(message);
      if (!understood) break;
      const auto* arrival = std::get_if<Arrival>(&*understood);
      if (arrival == nullptr) continue;
      std::visit(Checked{}, *arrival);
      if (std::holds_alternative<arrivals::BadResult>(*arrival)) ++refusals;
      if (const auto* taken = std::get_if<arrivals::Result>(arrival)) {
        ++results;
        EXPECT_EQ(taken->buffer.values, values);
      }
    }
  }
  EXPECT_GT(results, mutations() / 10);
  EXPECT_GT(refusals, mutations() / 10);
}

TEST(Mutation, AResultIsTheUnitsOwnOrRefused) {
  feed<wire::UnitResult>({result().result()}, [](const wire::UnitResult& message) {
    const auto decoded = decode(message, kUnit, kNoLayers);
    if (!decoded) return false;
    // The checksum is of the samples: those that were sent, or none.
    EXPECT_EQ(decoded->values, fake_samples(kUnit, kNoLayers).values);
    return true;
  });
}

TEST(Mutation, WhatSchedulersSay) {
  wire::Unit unit;
  encode(kId, 0, *unit.mutable_id());
  encode(kUnit, unit);
  feed<wire::Unit>({unit}, [](const wire::Unit& message) {
    const auto decoded = decode(message);
    if (!decoded) return false;
    EXPECT_LE(decoded->width, kMaxTile);
    EXPECT_GE(decoded->width, 1);
    EXPECT_LE(decoded->height, kMaxTile);
    EXPECT_GE(decoded->height, 1);
    EXPECT_LE(decoded->sample_count, kMaxSamplesPerUnit);
    return true;
  });
  wire::DeviceOptions device;
  encode(DeviceOptions{.threads = 4, .opencl_device = "pocl"}, device);
  feed<wire::DeviceOptions>({device}, [](const wire::DeviceOptions& message) {
    const auto decoded = decode(message);
    if (decoded) {
      EXPECT_GE(decoded->threads, 1);
      EXPECT_LE(decoded->threads, 4096);
    }
    return decoded.has_value();
  });
}

TEST(Mutation, WhatWatchersAsk) {
  wire::ControlRequest view, samples;
  encode(View{}, *view.mutable_change_view());
  samples.mutable_want_samples()->set_view(1);
  samples.mutable_want_samples()->set_spp(16);
  feed<wire::ControlRequest>({view, samples}, [](const wire::ControlRequest& message) {
    if (!message.has_change_view()) return message.has_want_samples();
    const auto decoded = decode(message.change_view());
    if (decoded)
      for (const float value : as_floats(decoded->camera)) EXPECT_TRUE(std::isfinite(value));
    return decoded.has_value();
  });
}

TEST(Mutation, WhatWatchersAreTold) {
  WatchedJob job;
  job.film_width = job.width = 8;
  job.film_height = job.height = 6;
  job.title = "a.xml";
  feed<wire::WatchedJob>({encode(job).job()}, [](const wire::WatchedJob& message) {
    const auto decoded = decode(message);
    if (decoded) {
      EXPECT_GT(decoded->width, 0);
      for (const double axis : decoded->center) EXPECT_TRUE(std::isfinite(axis));
      expect_text(decoded->title, kLongestText);
      EXPECT_LE(decoded->x + decoded->width, decoded->film_width);
    }
    return decoded.has_value();
  });
  TileSnapshot tile;
  tile.width = 4;
  tile.height = 2;
  tile.samples = 3;
  tile.radiance.assign(24, 0.5f);
  tile.standard_error.assign(8, 0.1f);
  const wire::WatchEvent event = encode(WatchItem{std::make_shared<const TileSnapshot>(tile)});
  feed<wire::TileState>({event.tile()}, [&](const wire::TileState& message) {
    const auto decoded = decode(message, job);
    if (decoded) {
      EXPECT_LE(decoded->x + decoded->width, job.film_width);
      EXPECT_LE(decoded->y + decoded->height, job.film_height);
    }
    return decoded.has_value();
  });
  wire::NumberedView view;
  view.set_number(3);
  encode(View{}, *view.mutable_view());
  feed<wire::NumberedView>({view},
                           [](const wire::NumberedView& message) { return decode(message).has_value(); });
  feed<wire::Progress>({[] {
                         wire::Progress progress;
                         progress.set_samples_done(100);
                         progress.set_relative_error(0.5);
                         progress.add_workers()->set_name("node7:1");
                         return progress;
                       }()},
                       [](const wire::Progress& message) {
                         const WatchProgress progress = decode(message);
                         for (const auto& worker : progress.workers) expect_text(worker.name, kLongestName);
                         return progress.samples_done > 0;
                       });
}

}  // namespace
}  // namespace penumbra
