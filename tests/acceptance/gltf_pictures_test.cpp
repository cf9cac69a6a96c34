// Small glTF files whose pictures follow from the specification.
#include <gtest/gtest.h>

#include <string>

#include "scenes/settings.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr int kSide = 32;

/// The render of a file in gltf/, of kSide x kSide pixels.
statistics::Image picture(const std::string& name) {
  SceneDescription scene = read_or_throw(project_file("tests/acceptance/gltf/" + name + ".gltf"));
  resize_film(scene, kSide, kSide);
  if (!apply_setting(scene, "film.rfilter", "box")) throw std::runtime_error("no box filter");
  scene.sampler.spp = 64;
  return mean_image(render_or_throw(scene));
}

/// Mean of a channel over the columns [first, end).
double mean_of(const statistics::Image& image, int first, int end, int channel) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = first; x < end; ++x) sum += image.at(x, y, channel);
  return sum / (double(image.height) * (end - first));
}

TEST(GltfPictures, AWhiteDielectricInAWhiteFurnaceIsWhite) {
  const statistics::Image image = picture("white-furnace");
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(channel_mean(image, c), 1.0, 1e-3);
  }
}

/// Two halves of one quad, which the same normal map leans the same way. The texture coordinates of one are
/// mirrored.
TEST(GltfPictures, MirroredCoordinatesHaveTheSameBumps) {
  for (const std::string name : {"mirrored-uv", "mirrored-uv-tangent"}) {
    const statistics::Image image = picture(name);
    // Without the border between the halves.
    const double left = mean_of(image, 2, kSide / 2 - 2, 0),
                 right = mean_of(image, kSide / 2 + 2, kSide - 2, 0);
    EXPECT_NEAR(left / right, 1.0, 0.01) << name;
    EXPECT_GT(left, 0.3) << name;
  }
}

/// A yellow emitter whose right half is cut out by its alpha, in front of a blue one.
TEST(GltfPictures, WhatIsCutOutDoesNotShine) {
  const statistics::Image image = picture("emissive-mask");
  EXPECT_NEAR(mean_of(image, kSide / 2 + 4, kSide, 0), 0.0, 1e-6);
  EXPECT_NEAR(mean_of(image, kSide / 2 + 4, kSide, 2), 1.0, 1e-3);
  EXPECT_GT(mean_of(image, 8, kSide / 2 - 4, 0), 0.9);
}

}  // namespace
}  // namespace penumbra
