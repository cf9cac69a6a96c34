// Reading pbrt-v4: transforms, lights, materials, and errors in files.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "scenes/bsdfs/half_space.h"
#include "scenes/image/bitmap_values.h"
#include "scenes/instances.h"
#include "scenes/pbrt/image_lights.h"
#include "scenes/scattering.h"
#include "scenes/settings.h"
#include "tests/scenes/gzip_writer.h"
#include "tests/scenes/pbrt_text.h"
#include "tests/scenes/ply_writer.h"
#include "tests/scenes/png_writer.h"
#include "tests/support/tga_file.h"

namespace penumbra::pbrt_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(PbrtText, ItsDefaultsArePbrts) {
  const SceneDescription scene = good_pbrt(kTriangle);
  EXPECT_EQ(scene.film.width, 1280);
  EXPECT_EQ(scene.film.height, 720);
  EXPECT_EQ(scene.camera.fov, 90.0);
  EXPECT_EQ(scene.camera.fov_axis, FovAxis::kSmaller);
  EXPECT_EQ(scene.sampler.spp, 16u);
  EXPECT_EQ(print_setting(scene, "integrator.max_depth"), "6") << "5 surfaces are 6 edges";
  EXPECT_EQ(std::get<DiffuseBsdf>(front(scene)).reflectance.value, glm::vec3(0.5f));
  EXPECT_EQ(scene.shapes[0].front_bsdf, scene.shapes[0].back_bsdf);
}

TEST_F(PbrtText, ProgressivePhotonMapsAreAsManyAsSamples) {
  const auto sppm = [&](std::string_view parameters, std::string_view film = "") {
    return good_pbrt(kTriangle, "Camera \"perspective\"\nIntegrator \"sppm\" " + std::string(parameters) +
                                    "\n" + std::string(film));
  };
  const SceneDescription plain = sppm("");
  ASSERT_TRUE(plain.integrator.is<ProgressivePhotonIntegrator>());
  const auto& defaults = *plain.integrator.get<ProgressivePhotonIntegrator>();
  EXPECT_EQ(defaults.max_depth, 6) << "5 surfaces are 6 edges";
  EXPECT_EQ(defaults.photon_count, 1280 * 720) << "as many as the film has pixels";
  EXPECT_EQ(defaults.initial_radius, 1.0f);
  EXPECT_EQ(defaults.alpha, std::nullopt) << "2/3";
  EXPECT_EQ(warnings(plain), "");
  const SceneDescription all = sppm(
      "\"integer maxdepth\" 9 \"integer photonsperiteration\" 5000 \"float radius\" 0.25 "
      "\"integer seed\" 7");
  const auto& given = *all.integrator.get<ProgressivePhotonIntegrator>();
  EXPECT_EQ(given.max_depth, 10);
  EXPECT_EQ(given.photon_count, 5000);
  EXPECT_EQ(given.initial_radius, 0.25f);
  EXPECT_EQ(warnings(all), "");
  // The film may come later, and its crop window counts.
  const SceneDescription cropped =
      sppm("",
           "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100 \"integer "
           "pixelbounds\" [0 50 0 20]");
  EXPECT_EQ(cropped.integrator.get<ProgressivePhotonIntegrator>()->photon_count, 50 * 20);
  const SceneDescription large =
      sppm("", "Film \"rgb\" \"integer xresolution\" 8000 \"integer yresolution\" 8000");
  EXPECT_EQ(large.integrator.get<ProgressivePhotonIntegrator>()->photon_count, MAX_PHOTONS);
  // Of version 3.
  EXPECT_THAT(warnings(sppm("\"integer numiterations\" 9 \"integer imagewritefrequency\" 9")),
              AllOf(HasSubstr("numiterations is ignored"), HasSubstr("pixelsamples")));
  const auto error = [&](const char* parameters) {
    return wrong(kTriangle, std::string("Camera \"perspective\"\nIntegrator \"sppm\" ") + parameters);
  };
  EXPECT_THAT(error("\"integer photonsperiteration\" 1000000000"),
              AllOf(HasSubstr("scene.pbrt:2:"), HasSubstr("photon_count"), HasSubstr("from 1 to 16777216")));
  EXPECT_THAT(error("\"float radius\" -1"), AllOf(HasSubstr("scene.pbrt:2:"), HasSubstr("initial_radius")));
}

TEST_F(PbrtText, TheCameraSeesWhatPbrtsSees) {
  // pbrt: x = w/2 (1 + X/(Z tan)), with X along up x view, to the right; the angle spans the shorter side.
  const SceneDescription scene =
      good_pbrt(kTriangle,
                "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n"
                "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100");
  const glm::dvec3 point(0.5, 0.25, 1.0);
  const double half = std::tan(20 * std::numbers::pi / 180);
  const glm::dvec2 expected(100 + 50 * point.x / ((point.z + 5) * half),
                            50 - 50 * point.y / ((point.z + 5) * half));
  EXPECT_GT(expected.x, 100.0) << "+x is to the right";
  const glm::dvec3 seen(glm::inverse(scene.camera.to_world) * glm::dvec4(point, 1));
  EXPECT_NEAR(100 - 50 * seen.x / (seen.z * half), expected.x, 1e-9);
  EXPECT_NEAR(50 - 50 * seen.y / (seen.z * half), expected.y, 1e-9);
}

TEST_F(PbrtText, ScreenWindowsAndCrops) {
  const SceneDescription scene =
      good_pbrt(kTriangle,
                "Camera \"perspective\" \"float fov\" 90 \"float screenwindow\" [-0.5 0.5 -0.25 0.25]\n"
                "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100 "
                "\"float cropwindow\" [0.25 0.5 0 0.101]");
  EXPECT_NEAR(scene.camera.fov, 2 * std::atan(0.5) * 180 / std::numbers::pi, 1e-12);
  EXPECT_EQ(scene.camera.fov_axis, FovAxis::kX);
  EXPECT_EQ(scene.film.crop_x, 50);
  EXPECT_EQ(scene.film.crop_width, 50);
  EXPECT_EQ(scene.film.crop_height, 11);
}

TEST_F(PbrtText, TransformsApplyFromTheInside) {
  const SceneDescription scene = good_pbrt(
      std::string("AttributeBegin\nTranslate 1 0 0\nRotate 90 0 0 1\nScale 2 2 2\n") + kTriangle +
      "AttributeEnd\n"
      "Transform [1 0 0 0  0 1 0 0  0 0 1 0  7 8 9 1]\nCoordinateSystem \"there\"\nIdentity\n" +
      kTriangle +
      "TransformBegin\nCoordSysTransform \"there\"\nConcatTransform [2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1]\n" +
      kTriangle + "TransformEnd\n" + kTriangle);
  ASSERT_EQ(scene.shapes.size(), 4u);
  expect_near(mesh(scene, 0).positions[1], {1, 2, 0});
  expect_near(mesh(scene, 1).positions[1], {1, 0, 0});
  expect_near(mesh(scene, 2).positions[1], {9, 8, 9});
  expect_near(mesh(scene, 3).positions[1], {1, 0, 0});
}

TEST_F(PbrtText, TheFrontIsWhereTheNormalOfItsOwnSpacePoints) {
  const std::string mirrored = std::string("AttributeBegin\nScale -1 1 1\n") + kTriangle + "AttributeEnd\n";
  const std::string turned =
      std::string("AttributeBegin\nReverseOrientation\n") + kTriangle + "AttributeEnd\n";
  const std::string with_normals =
      "AttributeBegin\nScale -1 1 1\nReverseOrientation\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 "
      "1 0] "
      "\"normal N\" [0 0 1 0 0 1 0 0 1] \"integer indices\" [0 1 2]\nAttributeEnd\n";
  const SceneDescription scene = good_pbrt(kTriangle + mirrored + turned + with_normals);
  ASSERT_EQ(scene.shapes.size(), 4u);
  expect_near(front_normal(scene, 0), {0, 0, 1});
  expect_near(front_normal(scene, 1), {0, 0, 1});
  expect_near(front_normal(scene, 2), {0, 0, -1});
  expect_near(front_normal(scene, 3), {0, 0, -1});
}

TEST_F(PbrtText, ObjectsAreWhereTheirInstancesAre) {
  const SceneDescription scene =
      good_pbrt(std::string("ObjectBegin \"o\"\nTranslate 0 0 1\n") + kTriangle + "ObjectEnd\n" +
                "AttributeBegin\nScale 2 2 2\nObjectInstance \"o\"\nAttributeEnd\nTranslate 5 0 "
                "0\nObjectInstance \"o\"\n");
  EXPECT_TRUE(scene.shapes.empty());
  ASSERT_EQ(scene.groups.size(), 1u) << "the mesh is there once";
  EXPECT_EQ(scene.instances.size(), 2u);
  const SceneDescription flat = without_instances(scene).value();
  ASSERT_EQ(flat.shapes.size(), 2u);
  expect_near(mesh(flat, 0).positions[1], {2, 0, 2});
  expect_near(mesh(flat, 1).positions[1], {6, 0, 1});
}

TEST_F(PbrtText, TheFrontOfAMirroredInstanceIsWhereItsNormalPoints) {
  const SceneDescription scene = good_pbrt(std::string("ObjectBegin \"o\"\nReverseOrientation\n") +
                                           kTriangle + "ObjectEnd\nScale 1 1 -1\nObjectInstance \"o\"\n");
  const SceneDescription flat = without_instances(scene).value();
  expect_near(front_normal(flat), {0, 0, 1});
}

TEST_F(PbrtText, ShapesOfAllKinds) {
  write("m.ply", odd_square_ply(PlyEncoding::kBigEndian));
  const SceneDescription scene = good_pbrt(
      "Shape \"sphere\" \"float radius\" 2\n"
      "AttributeBegin\nTranslate 1 2 3\nRotate 90 1 0 0\nShape \"disk\" \"float height\" 1 \"float radius\" "
      "[ 3 ]\n"
      "AttributeEnd\n"
      "Shape \"bilinearmesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0  1 1 0] \"point2 uv\" [0 0 1 0 0 1 1 1]\n"
      "Shape \"plymesh\" \"string filename\" \"m.ply\"\n");
  ASSERT_EQ(scene.shapes.size(), 4u);
  EXPECT_EQ(std::get<Sphere>(scene.shapes[0].geometry).radius, 2.0);
  const auto& disk = std::get<Disk>(scene.shapes[1].geometry);
  expect_near(disk.center, {1, 1, 3});
  expect_near(disk.normal, {0, -1, 0});
  EXPECT_EQ(disk.radius, 3.0);
  EXPECT_EQ(mesh(scene, 2).triangles, std::vector<glm::uvec3>({{0, 1, 3}, {0, 3, 2}}));
  expect_near(front_normal(scene, 2), {0, 0, 1});
}

TEST_F(PbrtText, LightsHaveTheRadianceThatPbrtsHave) {
  const SceneDescription scene = good_pbrt(
      std::string("LightSource \"point\" \"rgb I\" [1 2 3] \"float scale\" 2 \"point3 from\" [1 0 0]\n") +
      "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [3 2 1] \"bool twosided\" true\n" + kTriangle +
      "AttributeEnd\nAttributeBegin\nAreaLightSource \"diffuse\" \"float power\" 10\nScale 2 2 2\n" +
      "Shape \"sphere\"\nAttributeEnd\nLightSource \"infinite\" \"float illuminance\" 6\n");
  EXPECT_EQ(only<PointLight>(scene).intensity, glm::vec3(2, 4, 6));
  EXPECT_EQ(only<PointLight>(scene).position, glm::dvec3(1, 0, 0));
  EXPECT_EQ(scene.shapes.at(0).radiance, glm::vec3(3, 2, 1));
  EXPECT_TRUE(scene.shapes[0].two_sided_emission);
  // Power = pi area L.
  EXPECT_NEAR(scene.shapes.at(1).radiance->x, 10 / (std::numbers::pi * 16 * std::numbers::pi), 1e-6);
  EXPECT_NEAR(only<ConstantEnvironment>(scene).radiance.x, 6 / std::numbers::pi, 1e-6);
}

TEST_F(PbrtText, BlackBodiesHaveLuminance1) {
  const auto colour = [&](const char* kelvin) {
    return only<ConstantEnvironment>(
               good_pbrt(std::string(kTriangle) + "LightSource \"infinite\" \"blackbody L\" " + kelvin))
        .radiance;
  };
  for (const char* kelvin : {"2700", "6504", "12000"}) {
    const glm::vec3 c = colour(kelvin);
    EXPECT_NEAR(0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z, 1.0f, 2e-3f);
  }
  // Planckian locus at 2700 K: x = 0.4599, y = 0.4106 (Wyszecki and Stiles); as linear Rec. 709 of
  // luminance 1.
  const double x = 0.4599 / 0.4106, z = (1 - 0.4599 - 0.4106) / 0.4106;
  expect_near(
      glm::dvec3(colour("2700")),
      {3.2406 * x - 1.5372 - 0.4986 * z, -0.9689 * x + 1.8758 + 0.0415 * z, 0.0557 * x - 0.2040 + 1.0570 * z},
      0.01);
}

TEST_F(PbrtText, Materials) {
  const SceneDescription scene = good_pbrt(
      std::string("Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3]\n") + kTriangle +
      "Material \"conductor\" \"spectrum eta\" \"metal-Ag-eta\" \"spectrum k\" \"metal-Ag-k\" "
      "\"float roughness\" 0.25\n" +
      kTriangle + "Material \"conductor\" \"rgb reflectance\" [.5 .5 .5] \"float roughness\" 0\n" +
      kTriangle + "Material \"dielectric\" \"float eta\" 1.4\n" + kTriangle +
      "Material \"dielectric\" \"spectrum eta\" \"glass-BK7\" \"float uroughness\" 0.2 \"float "
      "vroughness\" 0.3 "
      "\"bool remaproughness\" false\n" +
      kTriangle + "Material \"coateddiffuse\" \"rgb reflectance\" [.4 .4 .4] \"float thickness\" 0\n" +
      kTriangle + "Material \"coateddiffuse\" \"float roughness\" 0.04\n" + kTriangle +
      "Material \"interface\"\n" + kTriangle +
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"b\" \"string "
      "type\" \"conductor\"\n" +
      "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.25\n" + kTriangle +
      "NamedMaterial \"a\"\n" +
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"float alpha\" 0.5\n");
  ASSERT_EQ(scene.shapes.size(), 10u);
  EXPECT_EQ(std::get<DiffuseBsdf>(front(scene, 0)).reflectance.value, glm::vec3(0.1f, 0.2f, 0.3f));
  const auto& silver = std::get<RoughConductorBsdf>(front(scene, 1));
  EXPECT_EQ(silver.alpha_u.value, 0.5f) << "the square root of the roughness";
  EXPECT_EQ(silver.distribution, DISTRIBUTION_GGX);
  // Mitsuba's indices have the colour of a constant emission, pbrt's are grey where they are constant.
  const glm::dvec3 mitsuba(conductor_index(*conductor_names().parse("Ag")).eta);
  expect_near(glm::dvec3(silver.eta.value), mitsuba / glm::dvec3(1.2048, 0.9483, 0.9089), 1e-4);
  // (eta, k) = (1, 2) reflect k² / (4 + k²) = 1/2 along the normal.
  EXPECT_NEAR(std::get<ConductorBsdf>(front(scene, 2)).k.value.x, 2.0f, 1e-6f);
  EXPECT_EQ(std::get<DielectricBsdf>(front(scene, 3)).int_ior, 1.4f);
  EXPECT_EQ(std::get<DielectricBsdf>(scene.bsdfs.at(std::size_t(scene.shapes[3].back_bsdf)).model).ext_ior,
            1.4f);
  const auto& glass = std::get<RoughDielectricBsdf>(front(scene, 4));
  EXPECT_EQ(glass.alpha_u.value, 0.2f);
  EXPECT_EQ(glass.alpha_v.value, 0.3f);
  EXPECT_EQ(glass.int_ior, 1.5168f);
  EXPECT_EQ(glass.abbe, 64.17f);
  // A boundary of index 1.5 reflects 0.5963 of diffuse light from below (Egan and Hilgeman 1979). pbrt's
  // light meets the base five times at most.
  const double base = double(std::get<PlasticBsdf>(front(scene, 5)).diffuse.value.x);
  double series = 0;
  for (int i = 0; i < 5; ++i) series += 0.4 * std::pow(0.4 * 0.5963, i);
  EXPECT_NEAR(base / (1 - 0.5963 * base), series, 1e-5);
  EXPECT_NEAR(std::get<RoughPlasticBsdf>(front(scene, 6)).alpha.value, 0.2f, 1e-6f);
  EXPECT_EQ(std::get<MaskBsdf>(front(scene, 7)).opacity.value, 0.0f) << "rays pass an interface";
  EXPECT_EQ(std::get<BlendBsdf>(front(scene, 8)).weight.value, 0.25f);
  EXPECT_TRUE(std::holds_alternative<ConductorBsdf>(
      scene.bsdfs.at(std::size_t(std::get<BlendBsdf>(front(scene, 8)).second)).model));
  EXPECT_EQ(std::get<MaskBsdf>(front(scene, 9)).opacity.value, 0.5f);
}

/// The series by which `maxdepth` ends light between the surfaces of a coateddiffuse, with a coating that
/// reflects `inside` of the light from below. Over the light that enters, that which reaches the coating.
double cut_series(double reflectance, double inside, int terms) {
  double sum = 0;
  for (int i = 0; i < terms; ++i) sum += reflectance * std::pow(reflectance * inside, i);
  return sum;
}

/// pbrt's light is dimmed on each way between the surfaces, also without a medium.
TEST_F(PbrtText, CoatingsAbsorbByTheirThickness) {
  const SceneDescription scene =
      good_pbrt("Material \"coateddiffuse\" \"rgb reflectance\" [.8 .8 .8]\n" + std::string(kTriangle) +
                "Material \"coateddiffuse\" \"float thickness\" 0.3 \"float roughness\" 0.04 \"rgb albedo\" "
                "[.5 .5 .5]\n" +
                kTriangle + "Material \"coatedconductor\" \"float thickness\" 0.2\n" + kTriangle);
  const auto& smooth = std::get<PlasticBsdf>(front(scene, 0));
  EXPECT_EQ(smooth.optical_depth, 0.01f);
  // 2 int mu R(mu) exp(-0.02 / mu) of a boundary of index 1.5 seen from below, by 2000 Gauss points on either
  // side of the critical angle.
  constexpr double kInside = 0.56736456;
  const double base = double(smooth.diffuse.value.x);
  EXPECT_NEAR(base / (1 - kInside * base), cut_series(0.8, kInside, 5), 1e-5);
  EXPECT_FLOAT_EQ(std::get<RoughPlasticBsdf>(front(scene, 1)).optical_depth, 0.15f) << "half is scattered";
  EXPECT_FLOAT_EQ(std::get<OpenPbrBsdf>(front(scene, 2)).coat_color.value.x, std::exp(-0.4f));
  EXPECT_THAT(warnings(scene), HasSubstr("the medium of a coating scatters nothing"));
}

/// With the metal's reflectances below a coating of index 1.5.
TEST_F(PbrtText, CoatedConductorsAreMetalsUnderACoat) {
  const SceneDescription scene = good_pbrt(
      std::string(
          "Material \"coatedconductor\" \"rgb conductor.eta\" [.2 .4 1.1] \"rgb conductor.k\" [3 2 2]\n"
          "\"float conductor.roughness\" 0.25 \"float interface.roughness\" 0\n") +
      kTriangle + "Material \"coatedconductor\" \"float interface.eta\" 1\n" + kTriangle);
  const auto& surface = std::get<OpenPbrBsdf>(front(scene, 0));
  EXPECT_EQ(surface.base_metalness.value, 1.0f);
  EXPECT_EQ(surface.coat_weight.value, 1.0f);
  EXPECT_EQ(surface.coat_ior, 1.5f);
  EXPECT_EQ(surface.coat_roughness.value, 0.0f);
  EXPECT_NEAR(surface.specular_roughness.value, std::pow(0.25, 0.25), 1e-6) << "alpha is 0.5";
  for (int c = 0; c < 3; ++c) {
    const double eta = std::array{.2, .4, 1.1}[std::size_t(c)] / 1.5,
                 k = std::array{3., 2., 2.}[std::size_t(c)] / 1.5;
    // Fresnel's equations with complex numbers.
    const auto reflectance = [&](double cosine) {
      const std::complex<double> n(eta, k), t = std::sqrt(1.0 - (1 - cosine * cosine) / (n * n));
      return 0.5 * (std::norm((cosine - n * t) / (cosine + n * t)) +
                    std::norm((n * cosine - t) / (n * cosine + t)));
    };
    const double along = reflectance(1), schlick = along + (1 - along) * std::pow(6.0 / 7, 5);
    EXPECT_NEAR(surface.base_color.value[c], along, 1e-5);
    EXPECT_NEAR(surface.specular_color.value[c] * schlick, std::min(reflectance(1.0 / 7), schlick), 1e-5);
  }
  EXPECT_TRUE(std::holds_alternative<ConductorBsdf>(front(scene, 1))) << "there is no coating";
  EXPECT_THAT(warnings(scene), HasSubstr("coatedconductor is approximated"));
}

TEST_F(PbrtText, MaterialsMayBeNamedBeforeTheyAreMade) {
  const SceneDescription scene = good_pbrt(
      std::string("NamedMaterial \"later\"\n") + kTriangle +
      "MakeNamedMaterial \"mixed\" \"string type\" \"mix\" \"string materials\" [\"later\" \"last\"]\n"
      "NamedMaterial \"mixed\"\n" +
      kTriangle +
      "MakeNamedMaterial \"later\" \"string type\" \"diffuse\" \"texture reflectance\" \"t\"\n"
      "MakeNamedMaterial \"last\" \"string type\" \"conductor\"\n"
      "Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [.1 .2 .3]\n");
  EXPECT_EQ(std::get<DiffuseBsdf>(front(scene, 0)).reflectance.value, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(std::get<BlendBsdf>(front(scene, 1)).first, scene.shapes[0].front_bsdf);
}

TEST_F(PbrtText, MaterialsThatAreApproximated) {
  const SceneDescription scene = good_pbrt(
      std::string("Material \"diffusetransmission\" \"rgb reflectance\" [.1 .2 .3] \"rgb transmittance\" "
                  "[.1 .1 .1] \"float scale\" 2\n") +
      kTriangle + "Material \"subsurface\" \"rgb reflectance\" [.5 .4 .3] \"float roughness\" 0\n" +
      kTriangle + "Material \"subsurface\" \"rgb sigma_s\" [1 1 1] \"rgb sigma_a\" [0 1 3]\n" + kTriangle +
      "Material \"dielectric\" \"spectrum eta\" [300 1.6 900 1.6]\n" + kTriangle);
  const auto& sheet = std::get<DiffuseTransmitterBsdf>(front(scene, 0));
  EXPECT_EQ(sheet.reflectance.value, glm::vec3(0.2f, 0.4f, 0.6f));
  EXPECT_EQ(sheet.transmittance.value, glm::vec3(0.2f));
  EXPECT_EQ(std::get<DielectricBsdf>(front(scene, 1)).int_ior, 1.33f);
  const auto inside = [&](std::size_t shape) {
    return scene.bsdfs.at(std::size_t(scene.shapes.at(shape).front_bsdf)).inside.value();
  };
  EXPECT_EQ(inside(1).extinction, glm::vec3(1.0f)) << "without a mean free path it is 1";
  // More has to come to the boundary than leaves it.
  const double internal = smooth_internal_reflectance(1.33);
  EXPECT_NEAR(HalfSpace(0).albedo(double(inside(1).albedo.x)), 0.5 / (1 - internal + 0.5 * internal), 1e-5);
  EXPECT_EQ(inside(2).extinction, glm::vec3(1.0f, 2.0f, 4.0f));
  EXPECT_EQ(inside(2).albedo, glm::vec3(1.0f, 0.5f, 0.25f));
  EXPECT_NEAR(std::get<DielectricBsdf>(front(scene, 3)).int_ior, 1.6f, 1e-4f);
  EXPECT_THAT(warnings(scene), HasSubstr("the reflectance of a subsurface"));
  const auto named = good_pbrt(
      std::string("Material \"subsurface\" \"string name\" \"Skin1\" \"float g\" .5 \"float scale\" 10\n") +
      kTriangle);
  const InnerMedium& skin = named.bsdfs.at(std::size_t(named.shapes.at(0).front_bsdf)).inside.value();
  const Scattering known = scattering_of("Skin1").value();
  EXPECT_THAT(warnings(named), Not(HasSubstr("subsurface")));
  EXPECT_EQ(skin.g, 0.0f) << "coefficients of names are reduced";
  EXPECT_NEAR(skin.extinction.y, 10 * (known.scattered.y + known.absorbed.y), 1e-4);
}

TEST_F(PbrtText, Hair) {
  const auto material = [&](const std::string& parameters) {
    return material_of(
        std::get<HairBsdf>(front(good_pbrt("Material \"hair\" " + parameters + "\n" + kTriangle), 0)));
  };
  const Material plain = material("");
  EXPECT_EQ(plain.ior, 1.55f);
  EXPECT_EQ(plain.alpha_u, 0.3f);
  EXPECT_EQ(plain.alpha_v, 0.3f);
  EXPECT_FLOAT_EQ(plain.tilt, float(2.0 / 360));
  EXPECT_EQ(plain.variant, HAIR_OFFSET_BY_V);
  // 1.3 of eumelanin, 0.419 0.697 1.37.
  EXPECT_NEAR(plain.transmitted.y, 0.9061, 1e-4);
  EXPECT_NEAR(material("\"float eumelanin\" 2 \"float pheomelanin\" 1").transmitted.z, 3.79, 1e-4);
  EXPECT_NEAR(material("\"float pheomelanin\" 1").transmitted.x, 0.187, 1e-4);
  const Material rough = material(
      "\"float beta_m\" .1 \"float beta_n\" .6 \"float alpha\" -3 \"float eta\" 1.4 \"rgb color\" [.1 .2 "
      ".3]");
  EXPECT_EQ(rough.alpha_u, 0.1f);
  EXPECT_EQ(rough.alpha_v, 0.6f);
  EXPECT_FLOAT_EQ(rough.tilt, float(-3.0 / 360));
  EXPECT_EQ(rough.ior, 1.4f);
  EXPECT_EQ(rough.variant, HAIR_OFFSET_BY_V | HAIR_OF_COLOUR);
  EXPECT_EQ(rough.diffuse.z, 0.3f);
  // The coefficient goes before the colour, the colour before pigments.
  const Material all =
      material("\"rgb sigma_a\" [3 2 1] \"rgb reflectance\" [.1 .2 .3] \"float eumelanin\" 1");
  EXPECT_EQ(all.variant, HAIR_OFFSET_BY_V);
  EXPECT_EQ(all.transmitted.x, 3);
  EXPECT_EQ(material("\"rgb reflectance\" [.1 .2 .3] \"float eumelanin\" 1").diffuse.y, 0.2f);
}

TEST_F(PbrtText, TheFilmsExposureIsTheLights) {
  const SceneDescription scene = good_pbrt(
      std::string("LightSource \"point\" \"rgb I\" [1 2 3]\nAreaLightSource \"diffuse\" \"rgb L\" [2 2 2] "
                  "\"float spread\" 30\n") +
          kTriangle,
      "Camera \"perspective\" \"float shutteropen\" 1 \"float shutterclose\" 1.5\n"
      "Film \"rgb\" \"float iso\" 400 \"string sensor\" \"canon_eos_5d\"");
  EXPECT_EQ(only<PointLight>(scene).intensity, glm::vec3(2, 4, 6));
  EXPECT_EQ(scene.shapes[0].radiance, glm::vec3(4.0f));
  EXPECT_THAT(warnings(scene), AllOf(HasSubstr("2 times as bright"), HasSubstr("'canon_eos_5d' is taken for"),
                                     HasSubstr("the spread of area lights")));
}

TEST_F(PbrtText, LightsWithTwoSidesAndPower) {
  const SceneDescription scene = good_pbrt(
      std::string("AreaLightSource \"diffuse\" \"rgb L\" [1 2 1] \"float power\" 10 \"bool twosided\" true\n"
                  "AttributeBegin\nScale 2 2 2\n") +
      kTriangle + "AttributeEnd\nShape \"cylinder\" \"float radius\" 2 \"float zmin\" 1 \"float zmax\" 4\n");
  const double one = 10 / (std::numbers::pi * 2 * 2.0);  // of both sides of an area of 2
  expect_near(glm::dvec3(scene.shapes[0].radiance.value()), {one, 2 * one, one}, 1e-6);
  EXPECT_TRUE(scene.shapes[0].two_sided_emission);
  EXPECT_NEAR(scene.shapes[1].radiance->x, 10 / (std::numbers::pi * 2 * 12 * std::numbers::pi), 1e-5)
      << "a mesh, whose area is 4e-5 smaller";
  EXPECT_TRUE(scene.shapes[1].two_sided_emission);
}

TEST_F(PbrtText, ImagesOfLights) {
  const std::vector<std::uint8_t> texels = {255, 0};
  write("t.tga", tga_file(1, 2, 1, texels));
  const SceneDescription scene = good_pbrt(
      "AreaLightSource \"diffuse\" \"string filename\" \"t.tga\" \"float power\" 10\n"
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 2 0 0 0 2 0] \"point2 uv\" [0 0 1 0 0 1]\n");
  ASSERT_NE(scene.shapes[0].radiance_texture, kNoTexture);
  // Half of the image is black.
  EXPECT_NEAR(scene.shapes[0].radiance->x, 10 / (std::numbers::pi * 2 * 0.5), 1e-5);
}

TEST_F(PbrtText, ColourSpaces) {
  const SceneDescription scene = good_pbrt(
      std::string("AttributeBegin\nColorSpace \"rec2020\"\nMaterial \"diffuse\" \"rgb reflectance\" [0.5 0.5 "
                  "0.5]\n") +
      kTriangle + "LightSource \"point\" \"rgb I\" [0.6274 0.0691 0.0164]\nAttributeEnd\n" +
      "Material \"diffuse\" \"rgb reflectance\" [0.5 0.25 0.5]\n" + kTriangle);
  expect_near(glm::dvec3(std::get<DiffuseBsdf>(front(scene, 0)).reflectance.value), glm::dvec3(0.5), 1e-6);
  // What ITU-R BT.2087 makes of red of Rec. 709.
  expect_near(glm::dvec3(only<PointLight>(scene).intensity), {1, 0, 0}, 2e-3);
  EXPECT_EQ(std::get<DiffuseBsdf>(front(scene, 1)).reflectance.value, glm::vec3(0.5f, 0.25f, 0.5f));
}

TEST_F(PbrtText, TexturesMadeOfImages) {
  const std::vector<std::uint8_t> a = {255, 51}, b = {51, 255};
  write("a.png", png_file(1, 2, 1, a));
  write("b.png", png_file(1, 2, 1, b));
  const SceneDescription scene = good_pbrt(
      "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"string encoding\" \"linear\"\n"
      "Texture \"b\" \"spectrum\" \"imagemap\" \"string filename\" \"b.png\" \"string encoding\" \"linear\"\n"
      "Texture \"product\" \"spectrum\" \"scale\" \"texture tex\" \"a\" \"texture scale\" \"b\"\n"
      "Texture \"mixture\" \"spectrum\" \"mix\" \"texture tex1\" \"a\" \"rgb tex2\" [0 0 0] \"float amount\" "
      "0.25\n"
      "Texture \"rough\" \"float\" \"imagemap\" \"string filename\" \"b.png\" \"string encoding\" \"linear\" "
      "\"bool invert\" true\n"
      "Texture \"dimmed\" \"float\" \"imagemap\" \"string filename\" \"b.png\" \"string encoding\" "
      "\"linear\" \"float scale\" 0.5 \"bool invert\" true\n"
      "Material \"diffuse\" \"texture reflectance\" \"product\"\n" +
      std::string(kTriangle) + "Material \"diffuse\" \"texture reflectance\" \"mixture\"\n" + kTriangle +
      "Material \"conductor\" \"texture roughness\" \"rough\"\n" + kTriangle +
      "Material \"conductor\" \"texture roughness\" \"dimmed\"\n" + kTriangle);
  const auto texels = [&](int texture) {
    const auto& model = std::get<BitmapTexture>(scene.textures.at(std::size_t(texture)).model);
    const Bitmap& bitmap = *scene.bitmaps.at(std::size_t(model.bitmap));
    return glm::dvec2(bitmap_value(bitmap, 0, model.gamma),
                      bitmap_value(bitmap, std::size_t(bitmap.channels), model.gamma));
  };
  const auto near = [](const glm::dvec2& x, const glm::dvec2& y) { return glm::length(x - y) < 1e-3; };
  EXPECT_TRUE(near(texels(std::get<DiffuseBsdf>(front(scene, 0)).reflectance.texture), {0.2, 0.2}));
  EXPECT_TRUE(near(texels(std::get<DiffuseBsdf>(front(scene, 1)).reflectance.texture), {0.75, 0.15}));
  const auto& metal = std::get<RoughConductorBsdf>(front(scene, 2));
  EXPECT_EQ(metal.alpha_u.texture, metal.alpha_v.texture);
  EXPECT_TRUE(near(texels(metal.alpha_u.texture), {std::sqrt(0.8), 0})) << "alpha is the square root";
  const auto& dimmed = std::get<RoughConductorBsdf>(front(scene, 3));
  EXPECT_TRUE(near(texels(dimmed.alpha_u.texture), {std::sqrt(0.9), std::sqrt(0.5)})) << "1 - scale * texel";
}

TEST_F(PbrtText, TexelsUnderACoatingAreCutAsConstantsAre) {
  write("t.png", png_file(1, 2, 1, std::vector<std::uint8_t>{230, 51}));
  const SceneDescription scene = good_pbrt(
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.png\" \"string encoding\" \"linear\"\n"
      "Texture \"c\" \"spectrum\" \"checkerboard\"\n"
      "Material \"coateddiffuse\" \"texture reflectance\" \"t\" \"integer maxdepth\" 3 \"float thickness\" "
      "0\n" +
      std::string(kTriangle) +
      "Material \"coateddiffuse\" \"texture reflectance\" \"c\" \"float roughness\" 0\n" + kTriangle);
  const auto& model = std::get<BitmapTexture>(
      scene.textures.at(std::size_t(std::get<PlasticBsdf>(front(scene)).diffuse.texture)).model);
  const Bitmap& bitmap = *scene.bitmaps.at(std::size_t(model.bitmap));
  // Of diffuse light below a boundary of index 1.5 (Duntley 1942).
  constexpr double kInside = 0.5963;
  for (const std::size_t i : {0, 1}) {
    const double r = (i == 0 ? 230 : 51) / 255.0;
    const double ours = double(bitmap_value(bitmap, 3 * i, model.gamma));
    EXPECT_NEAR(ours / (1 - ours * kInside), cut_series(r, kInside, 2), 2e-3) << r;
  }
  EXPECT_THAT(warnings(scene), HasSubstr("a texture that is no image"));
}

TEST_F(PbrtText, AnImageOfNumbersIsItsAlpha) {
  write("leaf.png", png_file(1, 2, 4, std::vector<std::uint8_t>{0, 0, 0, 255, 0, 0, 0, 51}));
  write("opaque.png", png_file(1, 2, 4, std::vector<std::uint8_t>{51, 51, 51, 255, 51, 51, 51, 255}));
  const SceneDescription scene = good_pbrt(
      "Texture \"a\" \"float\" \"imagemap\" \"string filename\" \"leaf.png\" \"string encoding\" \"linear\"\n"
      "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"leaf.png\"\n"
      "Texture \"b\" \"float\" \"imagemap\" \"string filename\" \"opaque.png\" \"string encoding\" "
      "\"linear\" "
      "\"float scale\" -2\n"
      "Material \"diffuse\" \"texture reflectance\" \"a\" \"texture displacement\" \"b\"\n"
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 0 0 1] \"texture alpha\" "
      "\"a\"\n");
  const auto bitmap = [&](int texture) {
    const auto& model = std::get<BitmapTexture>(scene.textures.at(std::size_t(texture)).model);
    return *scene.bitmaps.at(std::size_t(model.bitmap));
  };
  const auto& mask = std::get<MaskBsdf>(front(scene));
  EXPECT_NEAR(bitmap_value(bitmap(mask.opacity.texture), 1, 1.0f), 0.2, 1e-6);
  const Bsdf& leaf = scene.bsdfs.at(std::size_t(mask.inside));
  EXPECT_EQ(bitmap(std::get<DiffuseBsdf>(leaf.model).reflectance.texture).channels, 3)
      << "the colours' texture";
  const auto& bumps = std::get<ScaleTexture>(scene.textures.at(std::size_t(leaf.bend.texture)).model);
  EXPECT_EQ(bumps.scale.value, glm::vec3(-2.0f));
  EXPECT_NEAR(bitmap_value(bitmap(bumps.texture), 0, 1.0f), 0.2, 1e-6);
}

TEST_F(PbrtText, TexturesMappedByPlaces) {
  write("t.tga", tga_file(1, 2, 1, std::vector<std::uint8_t>{255, 0}));
  const auto texcoords = [&](const std::string& mapping, const std::string& points) {
    const SceneDescription scene = good_pbrt(
        "AttributeBegin\nTranslate 1 0 0\nTexture \"t\" \"spectrum\" \"imagemap\" \"string filename\" "
        "\"t.tga\" "
        "\"string mapping\" " +
        mapping + "\nAttributeEnd\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n" +
        "Shape \"trianglemesh\" \"point3 P\" " + points + " \"integer indices\" [0 1 2]\n");
    std::vector<glm::dvec2> corners;
    for (int i = 0; i < 3; ++i)
      corners.emplace_back(mesh(scene).texcoords.at(mesh(scene).triangles.at(0)[i]));
    return corners;
  };
  const auto near = [](const glm::dvec2& a, const glm::dvec2& b) { return glm::length(a - b) < 1e-6; };
  const auto plane = texcoords(
      "\"planar\" \"vector3 v1\" [2 0 0] \"vector3 v2\" [0 0 3] \"float udelta\" 0.5 \"float vdelta\" -1",
      "[1 0 0 2 0 0 1 0 1]");
  EXPECT_TRUE(near(plane[0], {0.5, -1}) && near(plane[1], {2.5, -1}) && near(plane[2], {0.5, 2}));
  // The seam is at -x.
  const auto tube = texcoords("\"cylindrical\"", "[2 0 0 1 -1 4 2 1 5]");
  EXPECT_TRUE(near(tube[0], {0.5, 0}) && near(tube[1], {0.25, 4}));
  const auto seam = texcoords("\"cylindrical\"", "[0 1 0 0 -1 4 1 1 5]");
  EXPECT_TRUE(near(seam[0], {0.875, 0}) && near(seam[1], {1.125, 4}) && near(seam[2], {0.75, 5}));
  const auto ball = texcoords("\"spherical\"", "[1 0 2 2 0 0 1 3 0]");
  EXPECT_TRUE(near(ball[0], {0, 0}) && near(ball[1], {0.5, 0}) && near(ball[2], {0.5, 0.25}));
}

TEST_F(PbrtText, PackedFilesAreUnpacked) {
  write("m.ply.gz", gzip_of(odd_square_ply(PlyEncoding::kAscii)));
  write("i.pbrt.gz", gzip_of(kTriangle));
  write("scene.pbrt.gz", gzip_of(pbrt("Shape \"plymesh\" \"string filename\" \"m.ply.gz\"\nInclude "
                                      "\"i.pbrt.gz\"\nImport \"i.pbrt.gz\"\n")));
  const auto scene = read_scene(folder_ / "scene.pbrt.gz", {});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->shapes.size(), 3u);
}

TEST_F(PbrtText, TexturesCountVFromTheBottom) {
  const std::vector<std::uint8_t> texels = {255, 0};
  write("t.png", png_file(1, 2, 1, texels));
  const SceneDescription scene = good_pbrt(
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.png\" \"float uscale\" 2 \"float "
      "vdelta\" 0.25 "
      "\"string encoding\" \"linear\"\nTexture \"s\" \"spectrum\" \"scale\" \"texture tex\" \"t\" \"float "
      "scale\" 0.5\n"
      "Texture \"c\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 0 0] \"rgb tex2\" [0 1 0]\n"
      "Texture \"m\" \"spectrum\" \"mix\" \"rgb tex1\" [1 0 0] \"rgb tex2\" [0 1 0] \"float amount\" 0.25\n"
      "Material \"diffuse\" \"texture reflectance\" \"s\"\n"
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 0 0 1]\n"
      "Material \"diffuse\" \"texture reflectance\" \"c\"\n"
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 0 0 1]\n"
      "Material \"diffuse\" \"texture reflectance\" \"m\"\n" +
      std::string(kTriangle));
  const auto reflectance = [&](std::size_t shape) {
    return std::get<DiffuseBsdf>(front(scene, shape)).reflectance;
  };
  const auto& scale = std::get<ScaleTexture>(scene.textures.at(std::size_t(reflectance(0).texture)).model);
  EXPECT_EQ(scale.scale.value, glm::vec3(0.5f));
  const SceneTexture& image = scene.textures.at(std::size_t(scale.texture));
  EXPECT_EQ(image.to_uv * glm::dvec3(1, 0, 1), glm::dvec3(2, 0.75, 1));
  EXPECT_EQ(std::get<BitmapTexture>(image.model).gamma, 1.0f);
  const SceneTexture& board = scene.textures.at(std::size_t(reflectance(1).texture));
  EXPECT_EQ(std::get<CheckerboardTexture>(board.model).color0.value, glm::vec3(1, 0, 0));
  EXPECT_EQ(board.to_uv * glm::dvec3(1, 1, 1), glm::dvec3(0.5, 0.5, 1)) << "squares of unit size";
  EXPECT_EQ(reflectance(2).value, glm::vec3(0.75f, 0.25f, 0));
}

TEST(PbrtOctahedron, IsItsInverseOfEqualAreas) {
  // The square's middle is +z, its corners -z, the middles of its edges the equator.
  EXPECT_EQ(pbrt::octahedral_square({0, 0, 1}), glm::dvec2(0.5, 0.5));
  const auto near = [](glm::dvec2 a, glm::dvec2 b) { return glm::length(a - b) < 1e-9; };
  EXPECT_TRUE(near(pbrt::octahedral_square({1, 0, 0}), {1.0, 0.5}));
  EXPECT_TRUE(near(pbrt::octahedral_square({0, -1, 0}), {0.5, 0.0}));
  // Uniform directions make a uniform square: 16 cells, 16000 points, chi-square of 15 degrees below its
  // 1e-6 quantile.
  std::mt19937_64 random(17);
  std::normal_distribution<double> normal;
  std::array<int, 16> counts{};
  for (int i = 0; i < 16000; ++i) {
    const glm::dvec2 at = pbrt::octahedral_square({normal(random), normal(random), normal(random)});
    ASSERT_TRUE(at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1);
    ++counts[std::size_t(std::min(int(4 * at.x), 3) + 4 * std::min(int(4 * at.y), 3))];
  }
  double chi = 0;
  for (const int count : counts) chi += (count - 1000.0) * (count - 1000.0) / 1000.0;
  EXPECT_LT(chi, 56.5);
}

TEST_F(PbrtText, ImagesOfTheSkyAreResampled) {
  // 16 x 16, the half with x > 0 white; it gets 128 rows.
  std::vector<std::uint8_t> texels(256, 0);
  for (std::size_t y = 0; y < 16; ++y)
    for (std::size_t x = 8; x < 16; ++x) texels[16 * y + x] = 255;
  write("sky.tga", tga_file(16, 16, 1, texels));
  const SceneDescription scene =
      good_pbrt(std::string(kTriangle) +
                "LightSource \"infinite\" \"string filename\" \"sky.tga\" \"float scale\" 3\n");
  const auto sky = only<EnvironmentMapLight>(scene);
  EXPECT_EQ(sky.scale, 3.0f);
  ASSERT_EQ(sky.image->width, 2 * sky.image->height);
  // Texel (x, y) is at (sin p sin t, cos t, -cos p sin t), p = 2 pi (x + 1/2) / W, t = pi y / (H - 1).
  ASSERT_EQ(sky.image->height, 128);
  for (const auto [column, expected] : {std::pair(64, 1.0), std::pair(192, 0.0)})  // p = 91 and 271 degrees
    EXPECT_EQ(bitmap_value(*sky.image, 3 * (std::size_t(64) * 256 + std::size_t(column)), 1.0f), expected);
}

TEST_F(PbrtText, TheIlluminanceOfAnImageIsAsPbrtCountsIt) {
  write("sky.tga", tga_file(16, 16, 1, std::vector<std::uint8_t>(256, 255)));
  const auto sky = only<EnvironmentMapLight>(
      good_pbrt(std::string(kTriangle) +
                "LightSource \"infinite\" \"string filename\" \"sky.tga\" \"float illuminance\" 3\n"));
  EXPECT_NEAR(sky.scale, 3 / (std::numbers::pi / 2), 0.04) << "half of pi";
}

TEST_F(PbrtText, SkiesThatAreTheSameEverywhereAddUp) {
  const SceneDescription scene =
      good_pbrt(std::string(kTriangle) +
                "LightSource \"infinite\" \"rgb L\" [1 2 3]\nLightSource \"infinite\" \"rgb L\" [1 1 1]\n");
  EXPECT_EQ(only<ConstantEnvironment>(scene).radiance, glm::vec3(2, 3, 4));
}

TEST_F(PbrtText, LightsOfImages) {
  // The upper row is white.
  write("beam.tga", tga_file(2, 2, 1, std::vector<std::uint8_t>{255, 255, 0, 0}));
  const auto beam = only<ProjectorLight>(
      good_pbrt(std::string(kTriangle) + "Translate 1 2 3\nLightSource \"projection\" \"string filename\" "
                                         "\"beam.tga\" \"float fov\" 60 \"float scale\" 2\n"));
  EXPECT_NEAR(beam.fov, 60, 1e-9);
  expect_near(glm::dvec3(beam.to_world[0]), {-1, 0, 0});
  expect_near(glm::dvec3(beam.to_world[3]), {1, 2, 3});
  write("all.tga", tga_file(16, 16, 1, std::vector<std::uint8_t>(256, 255)));
  const SceneDescription scene =
      good_pbrt(std::string(kTriangle) +
                "LightSource \"goniometric\" \"string filename\" \"all.tga\" \"float power\" 8\n");
  EXPECT_EQ(scene.emitters.size(), 6u);
  double power = 0;
  for (const Emitter& each : scene.emitters) {
    const auto& face = std::get<ProjectorLight>(each);
    EXPECT_NEAR(face.fov, 90, 1e-9);
    const auto& scale = std::get<ScaleTexture>(scene.textures.at(std::size_t(face.irradiance.texture)).model);
    const auto& image = std::get<BitmapTexture>(scene.textures.at(std::size_t(scale.texture)).model);
    const Bitmap& bitmap = *scene.bitmaps.at(std::size_t(image.bitmap));
    const int texels = bitmap.width * bitmap.height;
    // Irradiance of a square of area 4, pi times the image.
    for (int i = 0; i < texels; ++i)
      power += std::numbers::pi * double(scale.scale.value.x) *
               bitmap_value(bitmap, 3 * std::size_t(i), 1.0f) * 4 / texels;
  }
  EXPECT_NEAR(power, 8, 0.02);
}

TEST_F(PbrtText, IncludesImportsAndAttributes) {
  write("geometry.pbrt", std::string("Material \"diffuse\" \"rgb reflectance\" [0 1 0]\n") + kTriangle);
  const SceneDescription scene = good_pbrt(std::string("Import \"geometry.pbrt\"\n") + kTriangle +
                                           "Include \"geometry.pbrt\"\n" + kTriangle +
                                           "Attribute \"material\" \"rgb reflectance\" [1 0 0]\nAttribute "
                                           "\"shape\" \"float radius\" 2\nMaterial \"diffuse\"\n" +
                                           kTriangle);
  ASSERT_EQ(scene.shapes.size(), 5u);
  const auto colour = [&](std::size_t i) { return std::get<DiffuseBsdf>(front(scene, i)).reflectance.value; };
  EXPECT_EQ(colour(0), glm::vec3(0, 1, 0));
  EXPECT_EQ(colour(1), glm::vec3(0.5f)) << "what an import sets ends with it";
  EXPECT_EQ(colour(2), glm::vec3(0, 1, 0));
  EXPECT_EQ(colour(3), glm::vec3(0, 1, 0));
  EXPECT_EQ(colour(4), glm::vec3(1, 0, 0));
  EXPECT_EQ(scene.files.size(), 3u);
}

TEST_F(PbrtText, OfTwoParametersOfANameTheLaterCounts) {
  const SceneDescription scene = good_pbrt("Shape \"sphere\" \"float radius\" 1 \"float radius\" 2\n");
  EXPECT_EQ(std::get<Sphere>(scene.shapes[0].geometry).radius, 2.0);
  EXPECT_THAT(warnings(scene), HasSubstr("'radius' is there twice"));
}

TEST_F(PbrtText, OptionsHaveOneValue) {
  const SceneDescription scene =
      good_pbrt(kTriangle,
                "Option \"disablepixeljitter\" true\nOption \"bool pixelstats\" [ false ]\n"
                "Option \"seed\" 5\nOption \"string rendercoordsys\" \"world\"\nCamera \"perspective\"");
  EXPECT_EQ(scene.shapes.size(), 1u);
  EXPECT_THAT(warnings(scene), HasSubstr("Option is ignored"));
}

TEST_F(PbrtText, CoatingsOfAnyIndex) {
  const SceneDescription scene =
      good_pbrt(std::string("Material \"coateddiffuse\" \"float eta\" 1 \"rgb reflectance\" [.1 .2 .3]\n") +
                kTriangle + "Material \"coateddiffuse\" \"float eta\" 400\n" + kTriangle);
  EXPECT_EQ(std::get<DiffuseBsdf>(front(scene, 0)).reflectance.value, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(std::get<PlasticBsdf>(front(scene, 1)).int_ior, kMostIndexRatio);
}

TEST_F(PbrtText, WhatIsWrongIsSaidWithItsPlace) {
  EXPECT_THAT(wrong("Shap \"sphere\""),
              AllOf(HasSubstr("scene.pbrt:3:1: error: 'Shap' is not a directive"), HasSubstr("Shape")));
  EXPECT_THAT(wrong("Shape \"spher\""), AllOf(HasSubstr("shape 'spher' is not one"), HasSubstr("sphere")));
  EXPECT_THAT(wrong("Shape \"sphere\" \"float radius\" [1"),
              HasSubstr("scene.pbrt:3:31: error: this bracket"));
  EXPECT_THAT(wrong("Shape \"sphere\" \"float radius\" \"x\""), HasSubstr("'radius' needs numbers"));
  EXPECT_THAT(wrong("Shape \"sphere\" \"float radius\" -1"), HasSubstr("must be above 0"));
  EXPECT_THAT(wrong("Shape \"sphere\" \"flat radius\" 1"), HasSubstr("types are"));
  EXPECT_THAT(wrong("Shape \"sphere\" \"float radios\" 1"), HasSubstr("the parameter 'radios' of the shape"));
  EXPECT_THAT(wrong("Translate 1 2"), HasSubstr("3 numbers are wanted here"));
  EXPECT_THAT(wrong("Translate 1 2 x"), HasSubstr("scene.pbrt:3:15"));
  EXPECT_THAT(wrong("AttributeEnd"), HasSubstr("AttributeEnd without AttributeBegin"));
  EXPECT_THAT(wrong("AttributeBegin"), HasSubstr("there is no AttributeEnd for this"));
  EXPECT_THAT(wrong("Material \"diffuse\" \"texture reflectance\" \"t\""),
              HasSubstr("there is no texture 't'"));
  EXPECT_THAT(wrong("Material \"diffuse\" \"rgb reflectance\" [1 2 0]"),
              HasSubstr("must be in [0, 1], not 2"));
  EXPECT_THAT(wrong("NamedMaterial \"m\""), HasSubstr("there is no material 'm'"));
  EXPECT_THAT(wrong("ObjectInstance \"o\""), HasSubstr("there is no object 'o'"));
  EXPECT_THAT(wrong("Include \"none.pbrt\""), HasSubstr("there is no file 'none.pbrt'"));
  EXPECT_THAT(wrong("Include \"scene.pbrt\""), HasSubstr("error"));
  EXPECT_THAT(wrong("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]"),
              HasSubstr("an index 3, where there are 3 points"));
  EXPECT_THAT(wrong("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1]"), HasSubstr("3 for each"));
  EXPECT_THAT(wrong("Scale 0 1 1\nShape \"sphere\""), HasSubstr("flattens it"));
  EXPECT_THAT(wrong("Material \"velvet\""), HasSubstr("not one that Penumbra reads"));
  EXPECT_THAT(wrong("MakeNamedMaterial \"m\" \"string type\" \"diffuse\"\n"
                    "MakeNamedMaterial \"m\" \"string type\" \"diffuse\""),
              HasSubstr("the material 'm' is there twice"));
  EXPECT_THAT(wrong("MakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [\"m\" \"m\"]"),
              HasSubstr("mixes itself"));
  EXPECT_THAT(wrong("ColorSpace \"xyz\""), HasSubstr("none of srgb, rec2020"));
  EXPECT_THAT(wrong("Translate 1 1 \"open"), HasSubstr("no closing quote"));
  EXPECT_THAT(wrong("LightSource \"infinite\" \"blackbody L\" 3"), HasSubstr("100 to 1e6 K"));
  EXPECT_THAT(wrong(kTriangle, "Camera \"perspective\" \"float fov\" 180"), HasSubstr("fov must be between"));
  EXPECT_THAT(without_folder(read_pbrt("Camera \"perspective\"\nShape \"sphere\"").error().message),
              AllOf(HasSubstr("Shape belongs after WorldBegin"), HasSubstr("no WorldBegin")));
}

TEST_F(PbrtText, LeniencyStandsIn) {
  const SceneDescription scene =
      good_pbrt(std::string("Material \"velvet\"\n") + kTriangle +
                    "Shape \"heightfield\"\nMakeNamedMedium \"m\" \"string type\" \"fire\"\n",
                "Camera \"perspective\"", {.lenient = true});
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_THAT(warnings(scene), AllOf(HasSubstr("magenta diffuse"), HasSubstr("it is left out")));
}

}  // namespace
}  // namespace penumbra::pbrt_test
