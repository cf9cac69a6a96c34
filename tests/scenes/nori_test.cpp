// Nori's scenes: distinguished from Mitsuba's, and converted with the same meaning.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "scenes/settings.h"
#include "tests/scenes/scene_text.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class NoriText : public SceneText {
 protected:
  NoriText() {
    write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("round.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn .6 0 .8\nvn 0 0 1\nf 1//1 2//2 3//3\n");
  }
  static std::string nori(std::string_view content,
                          std::string_view camera = "<camera type=\"perspective\"/>") {
    return "<scene>\n" + std::string(camera) + "\n" + std::string(content) + "\n</scene>\n";
  }
  SceneDescription good_nori(std::string_view content,
                             std::string_view camera = "<camera type=\"perspective\"/>",
                             const ReadOptions& options = {}) {
    return lit(good_of(read(nori(content, camera), options)));
  }
  static constexpr const char* kMesh =
      "<mesh type=\"obj\"><string name=\"filename\" value=\"m.obj\"/></mesh>";
};

TEST_F(NoriText, ItsDefaultsAreNoris) {
  const SceneDescription scene = good_nori(kMesh);
  EXPECT_EQ(scene.film.width, 1280);
  EXPECT_EQ(scene.film.height, 720);
  EXPECT_EQ(scene.camera.fov, 30.0);
  EXPECT_EQ(scene.camera.fov_axis, FovAxis::kX);
  EXPECT_EQ(scene.camera.near_clip, 1e-4);
  EXPECT_EQ(scene.camera.far_clip, 1e4);
  ASSERT_EQ(scene.shapes.size(), 1u);
  const auto& diffuse = std::get<DiffuseBsdf>(scene.bsdfs.at(std::size_t(scene.shapes[0].front_bsdf)).model);
  EXPECT_EQ(diffuse.reflectance.value, glm::vec3(0.5f));
  EXPECT_EQ(scene.shapes[0].back_bsdf, kBlackBsdf) << "Nori's diffuse surfaces have one side";
  EXPECT_TRUE(std::get<Mesh>(scene.shapes[0].geometry).normals.empty()) << "without normals it is faceted";
}

/// Where a point of the scene is on the film, in pixels from its upper left corner, by the matrices of Nori's
/// perspective camera: x = w/2 (1 - cot(fov/2) x/z), y likewise over the same angle.
glm::dvec2 nori_pixel(glm::dvec3 in_camera, double fov, double width, double height) {
  const double cot = 1 / std::tan(fov * std::numbers::pi / 360);
  const double aspect = width / height;
  return {width * (-0.5 * (cot * in_camera.x / in_camera.z - 1)),
          height * (-0.5 * aspect * (cot * in_camera.y / in_camera.z - 1 / aspect))};
}

TEST_F(NoriText, TheCameraProjectsAsNorisDoes) {
  const SceneDescription scene = good_nori(
      kMesh,
      "<camera type=\"perspective\"><float name=\"fov\" value=\"40\"/><integer name=\"width\" value=\"200\"/>"
      "<integer name=\"height\" value=\"100\"/><transform name=\"toWorld\">"
      "<scale value=\"-1,1,1\"/><lookat target=\"0,0,0\" origin=\"0,0,-5\" "
      "up=\"0,1,0\"/></transform></camera>");
  // Nori's lookat has left = up x dir = +x and dir = +z; its mirror makes +x to the right.
  const glm::dvec3 point(0.5, 0.25, 1.0);
  const glm::dvec2 expected = nori_pixel({-point.x, point.y, point.z + 5}, 40, 200, 100);
  EXPECT_GT(expected.x, 100.0);
  EXPECT_LT(expected.y, 50.0);
  // Ours: +x of camera space is to the left of the image, the angle spans its width.
  const glm::dvec3 seen(glm::inverse(scene.camera.to_world) * glm::dvec4(point, 1));
  ASSERT_EQ(scene.camera.fov_axis, FovAxis::kX);
  const double half = std::tan(scene.camera.fov * std::numbers::pi / 360);
  EXPECT_NEAR(100 - 100 * seen.x / (seen.z * half), expected.x, 1e-9);
  EXPECT_NEAR(50 - 100 * seen.y / (seen.z * half), expected.y, 1e-9);
}

TEST_F(NoriText, TransformsAndMeshes) {
  const SceneDescription scene = good_nori(
      "<mesh type=\"obj\"><string name=\"filename\" value=\"round.obj\"/><transform name=\"toWorld\">"
      "<scale value=\"2,2,2\"/><rotate axis=\"0,0,1\" angle=\"90\"/><translate "
      "value=\"1,0,0\"/></transform></mesh>");
  const Mesh& mesh = std::get<Mesh>(scene.shapes.at(0).geometry);
  EXPECT_EQ(mesh.positions[1], glm::dvec3(1, 2, 0));
  ASSERT_FALSE(mesh.normals.empty());
  EXPECT_NEAR(mesh.normals[1].y, 0.6f, 1e-6f);
}

TEST_F(NoriText, MaterialsAndLights) {
  const SceneDescription scene = good_nori(
      "<mesh type=\"obj\"><string name=\"filename\" value=\"m.obj\"/>"
      "<bsdf type=\"diffuse\"><color name=\"albedo\" value=\"0.1,0.2,0.3\"/></bsdf>"
      "<emitter type=\"area\"><color name=\"radiance\" value=\"3,2,1\"/></emitter></mesh>"
      "<mesh type=\"obj\"><string name=\"filename\" value=\"m.obj\"/><bsdf type=\"mirror\"/></mesh>"
      "<mesh type=\"obj\"><string name=\"filename\" value=\"m.obj\"/><bsdf type=\"dielectric\"/></mesh>"
      "<mesh type=\"obj\"><string name=\"filename\" value=\"m.obj\"/>"
      "<bsdf type=\"microfacet\"><float name=\"alpha\" value=\"0.3\"/><float name=\"intIOR\" value=\"1.7\"/>"
      "<color name=\"kd\" value=\"0.1,0.2,0.2\"/></bsdf></mesh>"
      "<emitter type=\"point\"><point name=\"position\" value=\"1,2,3\"/>"
      "<color name=\"power\" value=\"12.566370614359172,0,0\"/></emitter>");
  const auto bsdf = [&](std::size_t i) -> const BsdfModel& {
    return scene.bsdfs.at(std::size_t(scene.shapes.at(i).front_bsdf)).model;
  };
  EXPECT_EQ(std::get<DiffuseBsdf>(bsdf(0)).reflectance.value, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(scene.shapes[0].radiance, glm::vec3(3, 2, 1));
  EXPECT_EQ(std::get<ConductorBsdf>(bsdf(1)).eta.value, glm::vec3(0.0f));
  EXPECT_EQ(std::get<DielectricBsdf>(bsdf(2)).int_ior, 1.5046f);
  EXPECT_EQ(std::get<MicrofacetDiffuseBsdf>(bsdf(3)).int_ior, 1.7f);
  const PointLight light = only<PointLight>(scene);
  EXPECT_EQ(light.position, glm::dvec3(1, 2, 3));
  EXPECT_NEAR(light.intensity.x, 1.0f, 1e-6f) << "a power of 4 pi is 1 W/sr";
}

TEST_F(NoriText, Integrators) {
  const auto setting = [&](const char* type, const char* key, const char* more = "") {
    return print_setting(
        good_nori(fmt::format("{}<integrator type=\"{}\">{}</integrator>", kMesh, type, more)), key);
  };
  EXPECT_EQ(setting("path_mis", "integrator.direct_sampling"), "mis");
  EXPECT_EQ(setting("path_mats", "integrator.direct_sampling"),
            setting("path_mats", "integrator.direct_sampling"));
  EXPECT_EQ(setting("direct_ems", "integrator.bsdf_samples"), "0");
  EXPECT_EQ(setting("direct_mats", "integrator.emitter_samples"), "0");
  EXPECT_EQ(setting("whitted", "integrator.indirect_samples"), "0");
  EXPECT_EQ(setting("av", "integrator.ray_length", "<float name=\"length\" value=\"3\"/>"), "3");
  EXPECT_EQ(setting("av", "integrator.background", "<float name=\"length\" value=\"3\"/>"), "1");
  EXPECT_EQ(setting("ao", "integrator.background"), "0");
}

TEST_F(NoriText, SamplersFiltersAndTests) {
  const SceneDescription scene = good_nori(
      "<sampler type=\"independent\"><integer name=\"sampleCount\" value=\"64\"/></sampler>"
      "<test type=\"ttest\"><string name=\"references\" value=\"0.5\"/></test>" +
          std::string(kMesh),
      "<camera type=\"perspective\"><rfilter type=\"mitchell\"><float name=\"B\" "
      "value=\"0.5\"/></rfilter></camera>");
  EXPECT_EQ(scene.sampler.spp, 64u);
  EXPECT_EQ(scene.sampler.kind, SamplerKind::kIndependent);
  EXPECT_EQ(scene.film.filter, FilterKind::kMitchell);
  EXPECT_EQ(scene.film.filter_b, 0.5f);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_THAT(scene.warnings[0], HasSubstr("<test> asks for no image"));
}

TEST_F(NoriText, MitsubasFilesAreNotTaken) {
  EXPECT_THAT(error("<scene><integrator type=\"path\"/></scene>"),
              HasSubstr("needs the attribute 'version'"));
  EXPECT_THAT(error("<scene version=\"3.0.0\"><mesh type=\"obj\"/></scene>"),
              HasSubstr("<mesh> is not an element"));
}

TEST_F(NoriText, WhatIsWrongIsSaidWithItsPlace) {
  const auto wrong = [&](std::string_view content,
                         std::string_view camera = "<camera type=\"perspective\"/>") {
    return error(nori(content, camera));
  };
  EXPECT_THAT(
      wrong("<mash/>"),
      AllOf(HasSubstr("scene.xml:3:2: error: <mash> is not an element of a Nori scene"), HasSubstr("mesh")));
  EXPECT_THAT(
      wrong("<integrator type=\"wireframe\"/>"),
      AllOf(HasSubstr("scene.xml:3:19"), HasSubstr("integrator type 'wireframe'"), HasSubstr("path_mats")));
  EXPECT_THAT(wrong("<medium type=\"heterogeneous\"/>"), HasSubstr("medium type 'heterogeneous'"));
  EXPECT_THAT(wrong("<mesh type=\"obj\"><string name=\"filename\" value=\"none.obj\"/></mesh>"),
              HasSubstr("there is no file 'none.obj'"));
  EXPECT_THAT(wrong("<mesh type=\"obj\"><string name=\"filename\" value=\"m.obj\"/>"
                    "<bsdf type=\"diffuse\"><color name=\"albedo\" value=\"1,2\"/></bsdf></mesh>"),
              HasSubstr("a color has three numbers, not 2"));
  EXPECT_THAT(error("<scene>" + std::string(kMesh) + "</scene>"), HasSubstr("no <camera>"));
  EXPECT_THAT(wrong("", "<camera type=\"perspective\"><float name=\"fov\" value=\"190\"/></camera>"),
              HasSubstr("fov"));
  EXPECT_THAT(wrong("<sampler type=\"independent\"/><sampler type=\"independent\"/>"),
              HasSubstr("second <sampler>"));
  const auto lenient = read(nori(std::string("<integrator type=\"wireframe\"/>") + kMesh), {.lenient = true});
  ASSERT_TRUE(lenient) << lenient.error().message;
}

}  // namespace
}  // namespace penumbra
