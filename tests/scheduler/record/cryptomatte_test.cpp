// Compares Cryptomatte's hashes with published ones, and its layers with the film they are made of.
#include "scheduler/record/cryptomatte.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "scheduler/record/film_image.h"
#include "tests/support/film_layers.h"

namespace penumbra {
namespace {

using namespace std::string_view_literals;

// Vectors of MurmurHash3_x86_32 as they are in the tests of many implementations (smhasher and its ports).
TEST(Cryptomatte, HashIsMurmurHash3) {
  struct Vector {
    std::string_view bytes;
    std::uint32_t seed, hash;
  };
  for (const Vector& v : {Vector{""sv, 0, 0},
                          {""sv, 1, 0x514e28b7},
                          {""sv, 0xffffffff, 0x81f16f39},
                          {"\xff\xff\xff\xff"sv, 0, 0x76293b50},
                          {"!Ce\x87"sv, 0, 0xf55b516b},
                          {"!Ce\x87"sv, 0x5082edee, 0x2362f9de},
                          {"!Ce"sv, 0, 0x7e4a8634},
                          {"!C"sv, 0, 0xa0f7b07a},
                          {"!"sv, 0, 0x72661cf4},
                          {"\0\0\0\0"sv, 0, 0x2362f9de},
                          {"\0\0\0"sv, 0, 0x85f0b427},
                          {"\0\0"sv, 0, 0x30f4c306},
                          {"\0"sv, 0, 0x514e28b7},
                          {"aaaa"sv, 0x9747b28c, 0x5a97808a},
                          {"Hello, world!"sv, 0x9747b28c, 0x24884cba},
                          {"The quick brown fox jumps over the lazy dog"sv, 0x9747b28c, 0x2fa826cd}})
    EXPECT_EQ(murmur_hash3_32(v.bytes, v.seed), v.hash) << v.bytes;
}

// Of the specification's own tests in Psyop's decoder for Nuke, and of Gaffer's.
TEST(Cryptomatte, IdsAreThePublishedOnes) {
  const auto id = [](std::string_view name) { return std::bit_cast<float>(cryptomatte_hash(name)); };
  EXPECT_EQ(id("hello"), 6.0705627102400005616e-17f);
  EXPECT_EQ(id("\xd1\x80\xd0\xb0\xd0\xb2\xd0\xbd\xd0\xb8\xd0\xbd\xd0\xb0"), -1.3192631212399999468e-25f);
  EXPECT_EQ(id("m\xc3\xa4"
               "dchen"),
            6.2361298211599995797e+25f);
  EXPECT_EQ(cryptomatte_hash("/GAFFERBOT/C_torso_GRP/C_head_GRP/C_head_CPT/C_head001_REN"), 4226998693u);
  EXPECT_EQ(cryptomatte_hash("crypto_object") >> 4, 0xf834d0au) << "the key of its metadata";
}

TEST(Cryptomatte, IdsAreOrdinaryFloats) {
  int mended = 0;
  for (int i = 0; i < 100'000; ++i) {
    const std::string name = "shape-" + std::to_string(i);
    const std::uint32_t hash = murmur_hash3_32(name), id = cryptomatte_hash(name);
    EXPECT_TRUE(std::isnormal(std::bit_cast<float>(id))) << name;
    EXPECT_EQ(id & ~(1u << 23), hash & ~(1u << 23)) << "nothing but an exponent's lowest bit";
    mended += id != hash ? 1 : 0;
  }
  EXPECT_NEAR(mended, 100'000 * 2 / 256.0, 5 * std::sqrt(100'000 * 2 / 256.0));
  EXPECT_EQ(cryptomatte_hash(""), 1u << 23);
}

MatteNames three_mattes() {
  // Two objects of one material, and one object of two.
  return {
      .objects = {"a", "b"}, .materials = {"wood", "tin \"\xc3\xa4\""}, .mattes = {{0, 0}, {1, 0}, {1, 1}}};
}

TEST(Cryptomatte, MetadataNameBothLayersAndTheirManifests) {
  const MatteNames names = three_mattes();
  std::map<std::string, std::string> metadata;
  for (const auto& [key, value] : cryptomatte_metadata(names)) metadata[key] = std::get<std::string>(value);
  EXPECT_EQ(metadata.size(), 8u);
  for (const auto& [layer, has] :
       {std::pair("CryptoObject", &names.objects), std::pair("CryptoMaterial", &names.materials)}) {
    char digits[9];
    std::snprintf(digits, sizeof digits, "%08x", cryptomatte_hash(layer));
    const std::string key = "cryptomatte/" + std::string(digits, 7) + "/";
    EXPECT_EQ(metadata[key + "name"], layer);
    EXPECT_EQ(metadata[key + "hash"], "MurmurHash3_32");
    EXPECT_EQ(metadata[key + "conversion"], "uint32_to_float32");
    const nlohmann::json manifest = nlohmann::json::parse(metadata[key + "manifest"]);
    EXPECT_EQ(manifest.size(), has->size());
    for (const std::string& name : *has)
      EXPECT_EQ(std::stoul(manifest.at(name).get<std::string>(), nullptr, 16), cryptomatte_hash(name));
  }
}

/// A pixel of ten samples: so many met each matte.
Image image_of(const MatteNames& names, std::vector<std::uint32_t> pairs) {
  FilmAccumulator film(0, 0, 1, 1, FilmLayers(0, int(names.mattes.size())));
  SampleBuffer buffer{
      .width = 1, .height = 1, .planes = kNoLayers.planes(), .sample_count = 10, .values = {}};
  buffer.values.assign(kRadiancePlanes, 0.0f);
  buffer.mattes = {std::uint32_t(pairs.size() / 2)};
  buffer.mattes.insert(buffer.mattes.end(), pairs.begin(), pairs.end());
  EXPECT_TRUE(check_mattes(buffer, int(names.mattes.size())));
  film.add(0, 0, buffer);
  return image_of_film(film, 1, 1, &names);
}

float value(const Image& image, const char* channel) {
  return image.at(0, 0, image.channel(channel).value());
}

TEST(Cryptomatte, RanksFallAndEqualNamesAreOne) {
  const MatteNames names = three_mattes();
  const Image image = image_of(names, {NO_MATTE, 1, 1, 4, 2, 3, 3, 2});
  EXPECT_EQ(image.exact_channels, std::size_t(kCryptomatteChannels));
  const auto id = [](const char* name) { return std::bit_cast<float>(cryptomatte_hash(name)); };
  EXPECT_EQ(value(image, "CryptoObject00.R"), id("b"));
  EXPECT_EQ(value(image, "CryptoObject00.G"), 0.5f) << "of both its mattes";
  EXPECT_EQ(value(image, "CryptoObject00.B"), id("a"));
  EXPECT_EQ(value(image, "CryptoObject00.A"), 0.4f);
  EXPECT_EQ(value(image, "CryptoObject01.R"), 0.0f);
  EXPECT_EQ(value(image, "CryptoObject01.G"), 0.0f);
  EXPECT_EQ(value(image, "CryptoMaterial00.R"), id("wood"));
  EXPECT_EQ(value(image, "CryptoMaterial00.G"), 0.7f);
  EXPECT_EQ(value(image, "CryptoMaterial00.A"), 0.2f);
  EXPECT_EQ(value(image, "CryptoMaterial02.A"), 0.0f);
}

TEST(Cryptomatte, SixRanksAreKept) {
  MatteNames names{.objects = {}, .materials = {"m"}, .mattes = {}};
  std::vector<std::uint32_t> pairs;
  for (std::uint32_t i = 0; i < 10; ++i) {
    names.objects.push_back("object-" + std::to_string(i));
    names.mattes.push_back({i, 0});
    pairs.insert(pairs.end(), {i + 1, 1});
  }
  const Image image = image_of(names, pairs);
  double sum = 0;
  for (const char* group : {"CryptoObject00", "CryptoObject01", "CryptoObject02"})
    for (const char* pair : {".G", ".A"}) sum += value(image, (group + std::string(pair)).c_str());
  EXPECT_NEAR(sum, 0.6, 1e-6);
  EXPECT_EQ(value(image, "CryptoMaterial00.G"), 1.0f);
}

TEST(Cryptomatte, IsNotThereUnlessAskedFor) {
  const FilmAccumulator film(0, 0, 1, 1, kNoLayers);
  const Image image = image_of_film(film, 1, 1);
  EXPECT_EQ(image.exact_channels, 0u);
  EXPECT_FALSE(image.channel("CryptoObject00.R"));
}

}  // namespace
}  // namespace penumbra
