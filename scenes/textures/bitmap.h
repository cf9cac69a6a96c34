// Textures from image files, as in Mitsuba 3, including the parameters of version 0.6.
#pragma once

#include <string>

#include "scenes/image/bitmap_reader.h"
#include "scenes/image/bitmap_values.h"
#include "scenes/plugin_values.h"
#include "scenes/textured.h"

namespace penumbra {

enum class BitmapFilter { kNearest, kBilinear, kTrilinear, kAnisotropic };

struct BitmapTexture {
  static constexpr const char* kPlugin = "bitmap";
  static constexpr const char* kText = "an image file";
  std::string filename;
  BitmapFilter filter = BitmapFilter::kBilinear;
  int wrap = WRAP_REPEAT, wrap_u = WRAP_REPEAT, wrap_v = WRAP_REPEAT;
  bool raw = false;
  float gamma = kSrgb;  ///< decoding of integers: (n / most)^gamma, sRGB, or linear (1)
  BitmapChannels channel = BitmapChannels::kAll;
  int bitmap = -1;         ///< index into SceneDescription::bitmaps
  int times = kNoTexture;  ///< another texture, which multiplies it

  template <typename Row>
  static void parameters(const Row& row) {
    row("filename", &BitmapTexture::filename, FileName{}, "the image");
    row("filter_type", &BitmapTexture::filter,
        OneOf<BitmapFilter>{{{"nearest", BitmapFilter::kNearest},
                             {"bilinear", BitmapFilter::kBilinear},
                             {"trilinear", BitmapFilter::kTrilinear},
                             {"ewa", BitmapFilter::kAnisotropic}}},
        "what is between the centres of texels; trilinear and ewa are bilinear here");
    const OneOf<int> wraps{{{"repeat", WRAP_REPEAT},
                            {"mirror", WRAP_MIRROR},
                            {"clamp", WRAP_CLAMP},
                            {"zero", WRAP_ZERO},
                            {"one", WRAP_ONE}}};
    row("wrap_mode", &BitmapTexture::wrap, wraps, "what is beyond the edges");
    row("wrap_mode_u", &BitmapTexture::wrap_u, wraps, "the same to the sides alone");
    row("wrap_mode_v", &BitmapTexture::wrap_v, wraps, "... above and below");
    row("raw", &BitmapTexture::raw, TrueOrFalse{},
        "whole numbers are linear, as of normals; else they are sRGB");
    row("gamma", &BitmapTexture::gamma, NumberWithin{LowEnd::kClosed, -1.0f, 100.0f},
        "whole numbers count (n / most)^gamma; -1: sRGB");
    row("channel", &BitmapTexture::channel,
        OneOf<BitmapChannels>{{{"all", BitmapChannels::kAll},
                               {"r", BitmapChannels::kRed},
                               {"g", BitmapChannels::kGreen},
                               {"b", BitmapChannels::kBlue},
                               {"a", BitmapChannels::kAlpha}}},
        "one channel, as grey");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (!given("filename")) findings.push_back({"", "a bitmap needs a <string name=\"filename\" …>"});
    if (!given("wrap_mode_u")) wrap_u = wrap;
    if (!given("wrap_mode_v")) wrap_v = wrap;
    if (gamma != kSrgb && !(gamma > 0.0f))
      findings.push_back({"gamma", "gamma must be a number above 0, or -1 for sRGB"});
    if (raw && given("gamma") && gamma != 1.0f)
      findings.push_back({"gamma", "raw values have no gamma: give one of both"});
    if (raw) gamma = 1.0f;
    if (filter == BitmapFilter::kTrilinear || filter == BitmapFilter::kAnisotropic)
      findings.push_back({"filter_type", "its filter is bilinear, without smaller copies", true});
  }
};

/// The record without the position of its texels.
inline TextureNode texture_of(const BitmapTexture& bitmap) {
  TextureNode t{};
  t.texture0 = bitmap.times;
  t.texture1 = kNoTexture;
  t.wrap_u = bitmap.wrap_u;
  t.wrap_v = bitmap.wrap_v;
  t.nearest = bitmap.filter == BitmapFilter::kNearest ? 1 : 0;
  return t;
}

}  // namespace penumbra
