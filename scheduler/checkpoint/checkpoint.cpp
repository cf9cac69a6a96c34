#include "scheduler/checkpoint/checkpoint.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace penumbra {
namespace {

constexpr std::uint64_t kMagic = 0x746b'6863'7562'6e70;  // "pnbuchkt"
constexpr std::uint64_t kFormat = 3;
constexpr std::size_t kChecksumBytes = 16;
constexpr std::size_t kMostSettings = 4096;

void add_checksum(std::span<const std::uint8_t> bytes, ByteWriter& writer) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  writer.u64(hash.low64);
  writer.u64(hash.high64);
}

void write(const RenderIdentity& identity, ByteWriter& bytes) {
  bytes.text(identity.version);
  bytes.text(identity.worker);
  bytes.text(identity.scene);
  bytes.u64(identity.settings.size());
  for (const auto& [name, value] : identity.settings) {
    bytes.text(name);
    bytes.text(value);
  }
}

RenderIdentity read_identity(ByteReader& bytes) {
  RenderIdentity identity{
      .version = bytes.text(), .worker = bytes.text(), .scene = bytes.text(), .settings = {}};
  const std::uint64_t settings = bytes.u64();
  for (std::uint64_t i = 0; i < std::min<std::uint64_t>(settings, kMostSettings) && !bytes.failed(); ++i) {
    std::string name = bytes.text();
    identity.settings.emplace_back(std::move(name), bytes.text());
  }
  return identity;
}

}  // namespace

std::string identity_text(const RenderIdentity& identity) {
  std::vector<std::uint8_t> bytes;
  ByteWriter writer(bytes);
  write(identity, writer);
  return {bytes.begin(), bytes.end()};
}

std::string identity_difference(const RenderIdentity& there, const RenderIdentity& asked) {
  std::vector<std::string> texts;
  const auto compare = [&](const std::string& what, const std::string& of_file, const std::string& now) {
    if (of_file != now) texts.push_back(fmt::format("{}: {} there, {} here", what, of_file, now));
  };
  compare("version of penumbra", there.version, asked.version);
  if (there.worker != asked.worker) texts.emplace_back("another build of penumbra-worker");
  const std::map<std::string, std::string> of_file(there.settings.begin(), there.settings.end()),
      now(asked.settings.begin(), asked.settings.end());
  std::set<std::string> names;
  for (const auto& settings : {of_file, now})
    for (const auto& [name, value] : settings) names.insert(name);
  const auto value_of = [](const std::map<std::string, std::string>& settings, const std::string& name) {
    const auto found = settings.find(name);
    return found == settings.end() ? "none" : found->second;
  };
  for (const std::string& name : names)
    compare(name == "scene_hash" ? "content of the scene file" : name, value_of(of_file, name),
            value_of(now, name));
  // The scene's hash follows from the other entries, unless files that the scene refers to have changed.
  if (texts.empty() && there.scene != asked.scene) texts.emplace_back("what is in the scene");
  if (texts.empty() && there != asked) texts.emplace_back("the order of its settings");
  return fmt::format("{}", fmt::join(texts, "; "));
}

void encode_checkpoint(const RenderIdentity& identity, const Merge& merge, Seconds rendered,
                       std::vector<std::uint8_t>& bytes) {
  bytes.clear();
  ByteWriter writer(bytes);
  writer.u64(kMagic);
  writer.u64(kFormat);
  write(identity, writer);
  writer.f64(rendered);
  merge.write(writer);
}

void seal_checkpoint(std::vector<std::uint8_t>& bytes) {
  ByteWriter writer(bytes);
  add_checksum(bytes, writer);
}

Expected<ResumedState> decode_checkpoint(std::span<const std::uint8_t> bytes, const RenderIdentity& identity,
                                         Merge empty) {
  ByteReader reader(bytes);
  if (reader.u64() != kMagic) return fail("it is no checkpoint");
  if (const std::uint64_t format = reader.u64(); format != kFormat)
    return fail(fmt::format("it has the format {}; this version of penumbra knows {}", format, kFormat));
  if (bytes.size() < kChecksumBytes) return fail("it is damaged: it ends too early");
  const auto checked = bytes.first(bytes.size() - kChecksumBytes);
  std::vector<std::uint8_t> checksum;
  ByteWriter writer(checksum);
  add_checksum(checked, writer);
  if (!std::ranges::equal(checksum, bytes.last(kChecksumBytes)))
    return fail("it is damaged: its checksum is not that of its content");
  reader = ByteReader(checked.subspan(2 * sizeof(std::uint64_t)));
  const RenderIdentity there = read_identity(reader);
  if (reader.failed()) return fail("it is damaged: it ends too early");
  if (there != identity) return fail("it is of another render: " + identity_difference(there, identity));
  ResumedState before{.merge = std::move(empty), .rendered = reader.f64()};
  if (!std::isfinite(before.rendered) || before.rendered < 0) return fail("it is damaged: its time is none");
  if (auto read = before.merge.read(reader); !read) return fail("it is damaged: " + read.error().message);
  if (reader.failed() || reader.left() > 0) return fail("it is damaged: its length is wrong");
  return before;
}

}  // namespace penumbra
