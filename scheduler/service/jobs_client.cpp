#include "scheduler/service/jobs_client.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <span>

#include "jobs.grpc.pb.h"
#include "kernels/host/atomic_file.h"
#include "worker/keys/secrets.h"
#include "worker/keys/unreachable.h"
#include "worker/protocol/client.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

constexpr std::chrono::seconds kPatience{20};  // for an answer
constexpr std::chrono::milliseconds kTimeToConnect{200}, kTimeToAnswer{1000}, kTimeToExplain{2000};
constexpr std::size_t kBlockBytes = std::size_t(64)
                                    << 10;             // of which a scene is compared with the one before
constexpr std::chrono::minutes kTimeForTransfers{60};  // as for scenes between scheduler and workers

void prepare(grpc::ClientContext& context, const std::string& token, std::chrono::seconds patience) {
  show_token(context, token);
  context.set_deadline(std::chrono::system_clock::now() + patience);
}

/// The scene in pieces of its tables that are small enough for most to be alike in the next frame of a shot.
AssetManifest blocks_of(const DeviceScene& scene) {
  std::vector<std::size_t> starts;
  for (const SceneTable& table : kSceneTables) {
    const std::size_t begin = std::size_t((scene.header.tables.*table.span).offset) * sizeof(std::uint32_t);
    for (std::size_t at = 0; at == 0 || at < table.bytes(scene.header.tables); at += kBlockBytes)
      starts.push_back(begin + at);
  }
  std::ranges::sort(starts);
  return make_manifest(scene.head(), scene.body(), starts);
}

}  // namespace

struct JobsClient::Connection {
  explicit Connection(std::shared_ptr<grpc::Channel> opened)
      : channel(std::move(opened)), stub(wire::Jobs::NewStub(channel)) {}

  const std::shared_ptr<grpc::Channel> channel;
  const std::unique_ptr<wire::Jobs::Stub> stub;
};

JobsClient::JobsClient(std::string address, ClientAccess access)
    : address_(std::move(address)),
      access_(std::move(access)),
      connection_(std::make_unique<const Connection>(open_channel(address_, access_.keys.get()))) {}

JobsClient::~JobsClient() = default;

void JobsClient::connect(const std::function<void()>& is_slow) const {
  const auto begin = std::chrono::system_clock::now(), slow = begin + kTimeToAnswer, end = begin + kPatience;
  bool is_told = false;
  for (;;) {
    const grpc_connectivity_state state = connection_->channel->GetState(true);
    const auto now = std::chrono::system_clock::now();
    if ((state != GRPC_CHANNEL_IDLE && state != GRPC_CHANNEL_CONNECTING) || now >= end) return;
    if (!is_told && now >= slow) {
      is_told = true;
      is_slow();
    }
    connection_->channel->WaitForStateChange(state, is_told ? end : slow);
  }
}

template <typename Request>
Request JobsClient::request() const {
  Request made;
  made.set_protocol_version(kProtocolVersion);
  return made;
}

std::unexpected<Error> JobsClient::failed(const grpc::Status& status) {
  is_away_ = status.error_code() == grpc::StatusCode::UNAVAILABLE ||
             status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED;
  if (is_away_) {
    const std::string why = why_unreachable(address_, access_.keys.get(), kTimeToExplain);
    return fail(fmt::format("no service answers at {}: {}{}", address_,
                            why.empty() ? status_text(status) : why,
                            why == kNobodyListens ? "; `penumbra serve --listen ADDRESS` starts one" : ""));
  }
  if (status.error_code() == grpc::StatusCode::UNIMPLEMENTED)
    return fail(
        fmt::format("what answers at {} is no service: it takes no jobs (`penumbra serve` does)", address_));
  std::string text = fmt::format("{}: {}", address_, status_text(status));
  if (status.error_code() == grpc::StatusCode::UNAUTHENTICATED && access_.token.empty())
    text += fmt::format("; give it in the environment variable {}", kTokenVariable);
  if (status.error_code() == grpc::StatusCode::PERMISSION_DENIED && !why_no_secret_.empty())
    text += "; " + why_no_secret_;
  return fail(text);
}

std::string JobsClient::owner() {
  auto secret = submitter_secret();
  if (secret) return std::move(*secret);
  why_no_secret_ = secret.error().message;
  return {};
}

grpc::Status JobsClient::put_scene(const AssetManifest& manifest, const DeviceScene& scene,
                                   const AssetManifest* base) {
  std::map<std::string, std::uint64_t> places;  // of the base's pieces
  std::uint64_t place = 0;
  if (base != nullptr)
    for (const AssetPiece& piece : base->pieces) {
      places.emplace(piece.hash, place);
      place += piece.size;
    }
  grpc::ClientContext context;
  prepare(context, access_.token, kTimeForTransfers);
  wire::PutSceneReply reply;
  const auto writer = connection_->stub->PutScene(&context, &reply);
  auto chunk = request<wire::SceneChunk>();
  chunk.set_hash(manifest.hash);
  if (base != nullptr) chunk.set_base(base->hash);
  const std::vector<std::uint8_t> head = scene.head();
  bool is_read = true;
  const auto flush = [&] {
    if (is_read && (chunk.copy_bytes() > 0 || !chunk.data().empty())) is_read = writer->Write(chunk);
    sent_bytes_ += chunk.data().size();
    chunk.clear_copy_bytes();
    chunk.clear_data();
  };
  std::size_t begin = 0;  // of the piece, in head and body
  for (const AssetPiece& piece : manifest.pieces) {
    // No piece is of both head and body.
    const auto bytes = begin < head.size() ? std::span(head).subspan(begin, piece.size)
                                           : scene.body().subspan(begin - head.size(), piece.size);
    begin += piece.size;
    if (const auto found = places.find(piece.hash); found != places.end()) {
      const bool goes_on = chunk.copy_bytes() > 0 && chunk.copy_from() + chunk.copy_bytes() == found->second;
      if (!goes_on) {
        flush();
        chunk.set_copy_from(found->second);
      }
      chunk.set_copy_bytes(chunk.copy_bytes() + piece.size);
      continue;
    }
    if (chunk.copy_bytes() > 0) flush();
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t part = std::min(kAssetChunkBytes - chunk.data().size(), bytes.size() - at);
      chunk.mutable_data()->append(reinterpret_cast<const char*>(bytes.data()) + at, part);
      at += part;
      if (chunk.data().size() == kAssetChunkBytes) flush();
    }
  }
  flush();
  writer->WritesDone();
  return writer->Finish();
}

Expected<void> JobsClient::send_scene(const std::string& hash, const DeviceScene& scene) {
  grpc::ClientContext context;
  prepare(context, access_.token, kPatience);
  auto asked = request<wire::HasSceneRequest>();
  asked.set_hash(hash);
  wire::HasSceneReply reply;
  if (const grpc::Status status = connection_->stub->HasScene(&context, asked, &reply); !status.ok())
    return failed(status);
  if (reply.known()) return {};
  AssetManifest manifest = blocks_of(scene);
  manifest.hash = hash;  // its name; the service finds out if it is another's
  grpc::Status status = put_scene(manifest, scene, before_ ? &*before_ : nullptr);
  if (before_ && status.error_code() == grpc::StatusCode::NOT_FOUND)
    status = put_scene(manifest, scene, nullptr);
  if (!status.ok()) return failed(status);
  before_ = std::move(manifest);
  return {};
}

Expected<wire::SubmitReply> JobsClient::submit(const Submission& submission, const DeviceScene& scene) {
  if (const auto sent = send_scene(submission.scene, scene); !sent) return std::unexpected(sent.error());
  grpc::ClientContext context;
  prepare(context, access_.token, kPatience);
  auto asked = request<wire::SubmitRequest>();
  *asked.mutable_submission() = encode(submission);
  asked.mutable_submission()->set_owner(owner());
  wire::SubmitReply reply;
  if (const grpc::Status status = connection_->stub->Submit(&context, asked, &reply); !status.ok())
    return failed(status);
  return reply;
}

Expected<wire::StatusReply> JobsClient::status(const std::vector<JobId>& numbers) {
  // Makes the channel reconnect, which a call alone does not. So a client that asks repeatedly notices soon
  // that the service is back.
  if (is_away_) connection_->channel->WaitForConnected(std::chrono::system_clock::now() + kTimeToConnect);
  grpc::ClientContext context;
  prepare(context, access_.token, kPatience);
  auto asked = request<wire::StatusRequest>();
  for (const JobId number : numbers) asked.add_jobs(number);
  wire::StatusReply reply;
  if (const grpc::Status status = connection_->stub->Status(&context, asked, &reply); !status.ok())
    return failed(status);
  is_away_ = false;
  return reply;
}

Expected<void> JobsClient::change(JobId number, wire::ChangeRequest request) {
  grpc::ClientContext context;
  prepare(context, access_.token, kPatience);
  request.add_jobs(number);
  request.set_owner(owner());
  wire::ChangeReply reply;
  if (const grpc::Status status = connection_->stub->Change(&context, request, &reply); !status.ok())
    return failed(status);
  return {};
}

Expected<void> JobsClient::cancel(JobId number) {
  auto asked = request<wire::ChangeRequest>();
  asked.set_cancel(true);
  return change(number, std::move(asked));
}

Expected<void> JobsClient::set_priority(JobId number, int priority) {
  auto asked = request<wire::ChangeRequest>();
  asked.set_priority(priority);
  return change(number, std::move(asked));
}

Expected<void> JobsClient::retry(JobId number) {
  auto asked = request<wire::ChangeRequest>();
  asked.set_retry(true);
  return change(number, std::move(asked));
}

Expected<void> JobsClient::remove(JobId number) {
  auto asked = request<wire::ChangeRequest>();
  asked.set_remove(true);
  return change(number, std::move(asked));
}

Expected<void> JobsClient::close_group(JobId group) {
  auto asked = request<wire::ChangeRequest>();
  asked.set_whole(true);
  return change(group, std::move(asked));
}

Expected<void> JobsClient::fetch(JobId job, const wire::StoredFile& file, const std::filesystem::path& path) {
  grpc::ClientContext context;
  prepare(context, access_.token, kTimeForTransfers);
  auto asked = request<wire::FetchRequest>();
  asked.set_job(job);
  asked.set_name(file.name());
  const auto reader = connection_->stub->Fetch(&context, asked);
  std::vector<std::uint8_t> bytes;
  wire::FetchChunk chunk;
  while (bytes.size() <= file.bytes() && reader->Read(&chunk))
    bytes.insert(bytes.end(), chunk.data().begin(), chunk.data().end());
  if (bytes.size() > file.bytes()) context.TryCancel();
  const grpc::Status status = reader->Finish();
  if (bytes.size() == file.bytes() && status.ok()) return write_output(path, bytes);
  if (!status.ok() && bytes.size() <= file.bytes()) return failed(status);
  return fail(fmt::format("{} of job {} has {} bytes and not {}, as was said", file.name(), job, bytes.size(),
                          file.bytes()));
}

}  // namespace penumbra
