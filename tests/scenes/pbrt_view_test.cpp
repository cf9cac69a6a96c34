// Cameras and films of pbrt-v4: windows, transforms, exposure.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <numbers>

#include "scenes/image/bitmap_values.h"
#include "scenes/mitsuba/scene_writer.h"
#include "scenes/scene_description.h"
#include "scenes/transform.h"
#include "tests/scenes/pbrt_text.h"
#include "tests/support/panorama_directions.h"
#include "tests/support/tga_file.h"

namespace penumbra::pbrt_test {
namespace {

using ::testing::HasSubstr;

class PbrtView : public PbrtText {};

/// Where the camera shows a point, in pixels of the whole film from its upper left corner, by the meaning of
/// our settings.
glm::dvec2 shown(const SceneDescription& scene, const glm::dvec3& point) {
  const CameraSettings& camera = scene.camera;
  const HalfFilm half = half_film(camera, scene.film);
  const glm::dvec3 seen(glm::inverse(camera.to_world) * glm::dvec4(point, 1));
  const double depth = camera.projection == Projection::kOrthographic ? 1.0 : seen.z;
  return {scene.film.width * (0.5 - camera.principal_point_offset_x - 0.5 * seen.x / (depth * half.x)),
          scene.film.height * (0.5 - camera.principal_point_offset_y - 0.5 * seen.y / (depth * half.y))};
}

constexpr const char* kFilm = "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20\n";

/// pbrt: a point (X, Y, Z) of camera space is at (X, Y) / (Z tan(fov / 2)) of the screen, of which the window
/// fills the film, with y upwards.
glm::dvec2 on_film(const glm::dvec2& screen, const std::array<double, 4>& window) {
  return {40 * (screen.x - window[0]) / (window[1] - window[0]),
          20 * (window[3] - screen.y) / (window[3] - window[2])};
}

void expect_shown(const SceneDescription& scene, const glm::dvec3& point, const glm::dvec2& expected) {
  const glm::dvec2 found = shown(scene, point);
  EXPECT_NEAR(found.x, expected.x, 1e-9);
  EXPECT_NEAR(found.y, expected.y, 1e-9);
}

TEST_F(PbrtView, WindowsMayBeAnywhereAndOfAnyShape) {
  const double tangent = std::tan(20 * std::numbers::pi / 180);
  for (const glm::dvec3 point : {glm::dvec3(0.2, 0.3, 2.0), glm::dvec3(-0.4, 0.1, 1.0)}) {
    const glm::dvec2 seen = glm::dvec2(point) / point.z / tangent;
    expect_shown(
        good_pbrt(kTriangle, std::string("Camera \"perspective\" \"float fov\" 40 \"float screenwindow\" "
                                         "[-0.5 1.5 -1 0.8]\n") +
                                 kFilm),
        point, on_film(seen, {-0.5, 1.5, -1, 0.8}));
    expect_shown(good_pbrt(kTriangle, std::string("Camera \"perspective\" \"float fov\" 40 \"float "
                                                  "frameaspectratio\" 0.5\n") +
                                          kFilm),
                 point, on_film(seen, {-1, 1, -2, 2}));
    expect_shown(
        good_pbrt(kTriangle,
                  std::string("Camera \"orthographic\" \"float screenwindow\" [-2 1 -1 3]\n") + kFilm),
        point, on_film(glm::dvec2(point), {-2, 1, -1, 3}));
  }
}

TEST_F(PbrtView, PixelsThatAreNotSquareAreWrittenAndRefusedByMitsuba3) {
  const SceneDescription scene =
      good_pbrt(kTriangle, std::string("Camera \"perspective\" \"float frameaspectratio\" 0.5\n") + kFilm);
  EXPECT_NE(scene.camera.pixel_aspect, 1.0);
  std::vector<std::string> refused;
  const auto files = mitsuba::scene_files(scene, folder_ / "written.xml", &refused);
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_THAT(refused, ::testing::ElementsAre("Mitsuba 3's sensor 'perspective' has no 'pixel_aspect'"));
  for (const auto& file : *files) write(file.path.filename().string(), file.contents);
  const SceneDescription again = good_of(read_scene(folder_ / "written.xml", {}));
  EXPECT_EQ(again.camera.pixel_aspect, scene.camera.pixel_aspect);
}

TEST_F(PbrtView, TransformsScaleAndTiltCameras) {
  // The camera's space is the world's, scaled after it was turned: its axes are not at right angles.
  const double angle = 0.6;
  const std::string view =
      std::string("Rotate ") + std::to_string(angle * 180 / std::numbers::pi) + " 1 0 0\nScale 2 3 1\n";
  const glm::dvec3 point(0.3, -0.2, 2.0);
  const glm::dvec3 scaled = point * glm::dvec3(2, 3, 1);
  const glm::dvec3 seen(scaled.x, std::cos(angle) * scaled.y - std::sin(angle) * scaled.z,
                        std::sin(angle) * scaled.y + std::cos(angle) * scaled.z);
  const SceneDescription perspective =
      good_pbrt(kTriangle, view + "Camera \"perspective\" \"float fov\" 90\n" + kFilm);
  const glm::dvec2 found = shown(perspective, point),
                   expected = on_film(glm::dvec2(seen) / seen.z, {-2, 2, -1, 1});
  EXPECT_NEAR(found.x, expected.x, 1e-4) << "the angle has six decimals";
  EXPECT_NEAR(found.y, expected.y, 1e-4);
  const SceneDescription parallel = good_pbrt(kTriangle, view + "Camera \"orthographic\"\n" + kFilm);
  const glm::dvec2 flat = shown(parallel, point), wanted = on_film(glm::dvec2(seen), {-2, 2, -1, 1});
  EXPECT_NEAR(flat.x, wanted.x, 1e-4);
  EXPECT_NEAR(flat.y, wanted.y, 1e-4);
}

TEST_F(PbrtView, AParallelCameraWithALensSeesFromTheLens) {
  const SceneDescription scene = good_pbrt(
      kTriangle,
      std::string("Camera \"orthographic\" \"float lensradius\" 0.2 \"float focaldistance\" 3\n") + kFilm);
  EXPECT_EQ(scene.camera.projection, Projection::kPerspective);
  EXPECT_EQ(scene.camera.focus_distance, 3.0);
  // In focus it is where the parallel camera has it.
  expect_shown(scene, {0.5, 0.25, 3.0}, on_film({0.5, 0.25}, {-2, 2, -1, 1}));
}

TEST_F(PbrtView, WithoutADirectiveTheCameraIsAtTheOrigin) {
  const SceneDescription scene = lit(good_of(read_pbrt(pbrt(kTriangle, ""))));
  EXPECT_EQ(scene.camera.fov, 90.0);
  expect_near(glm::dvec3(scene.camera.to_world[2]), {0, 0, 1});
}

TEST_F(PbrtView, CropWindowsReplacePixelBounds) {
  const SceneDescription scene = good_pbrt(
      kTriangle,
      "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20 \"float cropwindow\" [0 0.5 0 1] "
      "\"integer pixelbounds\" [4 8 4 8]");
  EXPECT_EQ(scene.film.crop_width, 20);
  EXPECT_EQ(scene.film.crop_height, 20);
}

TEST_F(PbrtView, WhatIsWrongIsSaidWithItsPlace) {
  EXPECT_THAT(wrong(kTriangle, "Film \"rgb\" \"float exposuretime\" 0.5"),
              HasSubstr("'exposuretime' of the film"));
  EXPECT_THAT(wrong(kTriangle, "Camera \"perspective\" \"float shutterclose\" 0"),
              HasSubstr("no light comes in"));
  EXPECT_THAT(wrong(kTriangle, "Rotate 30 0 0 1\nScale 2 1 1\nRotate 30 0 0 1\nCamera \"perspective\""),
              HasSubstr("shears the camera's film"));
  EXPECT_THAT(wrong(kTriangle, "Film \"rgb\" \"float whitebalance\" 5"),
              HasSubstr("whitebalance is 1000 to"));
}

TEST_F(PbrtView, WhiteBalanceMakesTheIlluminantWhite) {
  // CIE 15:2004: D50 is (0.96422, 1, 0.82521) in XYZ, here to Rec. 709 by IEC 61966-2-1.
  const glm::dvec3 d50(0.96422, 1.0, 0.82521);
  const glm::dvec3 rgb(3.2406 * d50.x - 1.5372 * d50.y - 0.4986 * d50.z,
                       -0.9689 * d50.x + 1.8758 * d50.y + 0.0415 * d50.z,
                       0.0557 * d50.x - 0.2040 * d50.y + 1.0570 * d50.z);
  const SceneDescription scene =
      good_pbrt(std::string(kTriangle) + "LightSource \"point\" \"rgb I\" [" + std::to_string(rgb.x) + " " +
                    std::to_string(rgb.y) + " " + std::to_string(rgb.z) + "]\n",
                "Film \"rgb\" \"float whitebalance\" 5000");
  expect_near(glm::dvec3(only<PointLight>(scene).intensity), glm::dvec3(1.0), 5e-3);
  // The image of an area light is balanced, not its strength.
  write("l.tga", tga_file(1, 1, 1, std::vector<std::uint8_t>{255}));
  const SceneDescription image =
      good_pbrt("AreaLightSource \"diffuse\" \"string filename\" \"l.tga\"\n" + std::string(kTriangle),
                "Film \"rgb\" \"float whitebalance\" 5000");
  EXPECT_EQ(image.shapes[0].radiance, glm::vec3(1.0f));
  const auto& model =
      std::get<BitmapTexture>(image.textures.at(std::size_t(image.shapes[0].radiance_texture)).model);
  const Bitmap& bitmap = *image.bitmaps.at(std::size_t(model.bitmap));
  EXPECT_GT(bitmap_value(bitmap, 2, 1.0f), bitmap_value(bitmap, 0, 1.0f)) << "white is bluer than D50";
}

TEST_F(PbrtView, AmbientOcclusion) {
  const SceneDescription scene = good_pbrt(
      kTriangle, "Integrator \"ambientocclusion\" \"float maxdistance\" 2 \"bool cossample\" false");
  const auto& occlusion = std::get<AmbientOcclusionIntegrator>(scene.integrator.method);
  EXPECT_EQ(occlusion.ray_length, 2.0f);
  EXPECT_EQ(occlusion.background, 0.0f);
  EXPECT_EQ(occlusion.sampling, OcclusionSampling::kHemisphere);
  EXPECT_EQ(occlusion.weighting, OcclusionWeighting::kCosine);
}

/// pbrt's directions of its spherical camera in its camera space, x to the right, y up and z forwards:
/// GenerateRay of SphericalCamera, and EqualAreaSquareToSphere.
glm::dvec3 spherical_direction(bool equal_area, double u, double v) {
  if (!equal_area) {
    const double theta = std::numbers::pi * v, phi = 2 * std::numbers::pi * u;
    return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
  }
  const double a = 2 * u - 1, b = 2 * v - 1, d = 1 - std::abs(a) - std::abs(b), r = 1 - std::abs(d);
  const double phi = (r == 0 ? 1 : (std::abs(b) - std::abs(a)) / r + 1) * std::numbers::pi / 4;
  const double out = r * std::sqrt(2 - r * r);
  return {std::copysign(std::cos(phi) * out, a), std::copysign(1 - r * r, d),
          std::copysign(std::sin(phi) * out, b)};
}

TEST_F(PbrtView, SphericalCamerasSeeAllDirections) {
  const std::string place = "Scale -1 1 1\nRotate 30 0.3 1 0.2\nScale 2 2 2\nTranslate 1 2 3\n";
  for (const char* mapping : {"equalarea", "equirectangular", ""}) {
    const std::string parameter = *mapping == 0 ? "" : std::string(" \"string mapping\" \"") + mapping + "\"";
    const SceneDescription scene =
        good_pbrt(kTriangle, place + "Camera \"spherical\"" + parameter + "\n" + kFilm);
    const bool equal_area = std::string_view(mapping) != "equirectangular";
    EXPECT_EQ(scene.camera.projection, equal_area ? Projection::kEqualArea : Projection::kEquirectangular);
    // The transform from the world to pbrt's camera.
    glm::dmat4 to_camera = scaling(glm::dvec3(-1, 1, 1));
    to_camera = to_camera * rotation(glm::dvec3(0.3, 1, 0.2), 30) * scaling(glm::dvec3(2));
    to_camera = to_camera * translation(glm::dvec3(1, 2, 3));
    const glm::dmat4 to_world = glm::inverse(to_camera);
    EXPECT_LT(glm::length(scene.camera.to_world[3] - to_world[3]), 1e-9);
    for (double u = 0.03; u < 1; u += 0.11)
      for (double v = 0.04; v < 1; v += 0.11) {
        const glm::dvec3 expected =
            glm::normalize(glm::dmat3(to_world) * spherical_direction(equal_area, u, v));
        const glm::dvec3 found =
            glm::dmat3(scene.camera.to_world) * panorama_direction(scene.camera, scene.film, u, v).value();
        EXPECT_LT(glm::length(found - expected), 1e-9) << mapping << " " << u << ", " << v;
      }
  }
}

TEST_F(PbrtView, SphericalCamerasThatAreWrong) {
  EXPECT_THAT(wrong(kTriangle, "Camera \"spherical\" \"string mapping\" \"cube\""),
              HasSubstr("mapping must be equalarea or equirectangular, not 'cube'"));
  EXPECT_THAT(wrong(kTriangle, "Scale 1 2 1\nCamera \"spherical\""), HasSubstr("scale all axes alike"));
  EXPECT_THAT(wrong(kTriangle, "Camera \"spherical\" \"float fov\" 40"), HasSubstr("fov"));
}

}  // namespace
}  // namespace penumbra::pbrt_test
