#include "scheduler/record/cryptomatte.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <nlohmann/json.hpp>
#include <span>

#include "scheduler/plan/render_memory.h"

namespace penumbra {
namespace {

static_assert(kCryptomatteChannels == kMatteChannels);

struct Layer {
  const char* name;
  std::vector<std::string> MatteNames::*names;
};
constexpr std::array kLayers{Layer{"CryptoObject", &MatteNames::objects},
                             Layer{"CryptoMaterial", &MatteNames::materials}};

std::uint32_t mixed(std::uint32_t block) { return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u; }

std::vector<std::uint32_t> hashes_of(const std::vector<std::string>& names) {
  std::vector<std::uint32_t> hashes;
  hashes.reserve(names.size());
  for (const std::string& name : names) hashes.push_back(cryptomatte_hash(name));
  return hashes;
}

}  // namespace

std::uint32_t murmur_hash3_32(std::string_view bytes, std::uint32_t seed) {
  std::uint32_t hash = seed;
  const auto byte = [&](std::size_t i) { return std::uint32_t(std::uint8_t(bytes[i])); };
  std::size_t i = 0;
  for (; i + 4 <= bytes.size(); i += 4) {
    hash ^= mixed(byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24);
    hash = std::rotl(hash, 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t rest = 0;
  for (std::size_t k = bytes.size(); k > i; --k) rest = rest << 8 | byte(k - 1);
  hash ^= mixed(rest);
  hash ^= std::uint32_t(bytes.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

std::uint32_t cryptomatte_hash(std::string_view name) {
  const std::uint32_t hash = murmur_hash3_32(name), exponent = hash >> 23 & 255u;
  return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

std::vector<std::string> cryptomatte_channels() {
  std::vector<std::string> channels;
  for (const Layer& layer : kLayers)
    for (int group = 0; group < kCryptomatteRanks / 2; ++group)
      for (const char channel : {'R', 'G', 'B', 'A'})
        channels.push_back(fmt::format("{}{:02}.{}", layer.name, group, channel));
  return channels;
}

std::vector<std::pair<std::string, MetadataValue>> cryptomatte_metadata(const MatteNames& names) {
  std::vector<std::pair<std::string, MetadataValue>> metadata;
  for (const Layer& layer : kLayers) {
    const std::string key =
        fmt::format("cryptomatte/{:.7}/", fmt::format("{:08x}", cryptomatte_hash(layer.name)));
    nlohmann::json manifest = nlohmann::json::object();
    for (const std::string& name : names.*layer.names)
      manifest[name] = fmt::format("{:08x}", cryptomatte_hash(name));
    metadata.emplace_back(key + "name", std::string(layer.name));
    metadata.emplace_back(key + "hash", std::string("MurmurHash3_32"));
    metadata.emplace_back(key + "conversion", std::string("uint32_to_float32"));
    metadata.emplace_back(key + "manifest", manifest.dump());
  }
  return metadata;
}

CryptomattePixels::CryptomattePixels(const MatteNames& names)
    : names_(names), objects_(hashes_of(names.objects)), materials_(hashes_of(names.materials)) {}

void CryptomattePixels::append(const FilmAccumulator& film, int x, int y, std::vector<float>& values) {
  const std::span<const MatteWeight> mattes = film.mattes(x, y);
  const double samples = double(film.at(x, y).count);
  const auto collect = [&](const std::vector<std::uint32_t>& hashes, auto name_of) {
    ranks_.clear();
    for (const MatteWeight& each : mattes)
      ranks_.push_back({hashes[name_of(names_.mattes[std::size_t(each.matte) - 1])], each.weight});
    append_layer(samples, values);
  };
  collect(objects_, [](const MatteNames::Matte& matte) { return matte.object; });
  collect(materials_, [](const MatteNames::Matte& matte) { return matte.material; });
}

/// Merges ranks with equal names, then appends the largest.
void CryptomattePixels::append_layer(double samples, std::vector<float>& values) {
  std::ranges::sort(ranks_, {}, [](const Rank& rank) { return std::pair(rank.hash, rank.weight); });
  std::size_t distinct = 0;
  for (const Rank& rank : ranks_) {
    if (distinct > 0 && ranks_[distinct - 1].hash == rank.hash)
      ranks_[distinct - 1].weight += rank.weight;
    else
      ranks_[distinct++] = rank;
  }
  ranks_.resize(distinct, {});
  std::ranges::sort(ranks_, {}, [](const Rank& rank) { return std::pair(-rank.weight, rank.hash); });
  for (std::size_t rank = 0; rank < std::size_t(kCryptomatteRanks); ++rank) {
    const bool is_there = rank < ranks_.size();
    values.push_back(is_there ? std::bit_cast<float>(ranks_[rank].hash) : 0.0f);
    values.push_back(is_there ? float(ranks_[rank].weight / samples) : 0.0f);
  }
}

}  // namespace penumbra
