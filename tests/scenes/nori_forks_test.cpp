// Nori's two dialects, and extensions of courses: both are read with the same meaning.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "scenes/settings.h"
#include "tests/scenes/scene_text.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class NoriForks : public SceneText {
 protected:
  NoriForks() {
    write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    std::string image = "PF\n4 2\n-1.0\n";
    const float grey = 0.5f;
    for (int i = 0; i < 4 * 2 * 3; ++i) image.append(reinterpret_cast<const char*>(&grey), sizeof grey);
    write("image.pfm", image);
  }

  static std::string nori(std::string_view content, std::string_view camera = kCamera) {
    return fmt::format("<scene>\n{}\n{}\n</scene>\n", camera, content);
  }
  SceneDescription good_nori(std::string_view content, std::string_view camera = kCamera,
                             const ReadOptions& options = {}) {
    return lit(good_of(read(nori(content, camera), options)));
  }
  static std::string mesh(std::string_view inside, std::string_view tag = "mesh") {
    return fmt::format("<{0} type='obj'><string name='filename' value='m.obj'/>{1}</{0}>", tag, inside);
  }
  template <typename Model>
  const Model& model_of(const SceneDescription& scene, std::size_t shape = 0) {
    return std::get<Model>(scene.bsdfs.at(std::size_t(scene.shapes.at(shape).front_bsdf)).model);
  }
  template <typename Model>
  const Model& texture_of(const SceneDescription& scene, int texture) {
    return std::get<Model>(scene.textures.at(std::size_t(texture)).model);
  }

  static constexpr std::string_view kCamera = "<camera type='perspective'/>";
  static constexpr std::string_view kPlaced =
      "<camera type='perspective'><float name='fov' value='40'/><integer name='width' value='200'/><integer "
      "name='height' value='100'/><transform name='toWorld'><lookat target='1,2,3' origin='0,0,-5' "
      "up='0,1,0'/></transform></camera>";
};

/// Where a point is on a film of 200 x 100 pixels with an angle of 40 degrees, by our camera.
double pixel_column(const SceneDescription& scene, glm::dvec3 point) {
  const glm::dvec3 seen(glm::inverse(scene.camera.to_world) * glm::dvec4(point, 1));
  return 100 - 100 * seen.x / (seen.z * std::tan(scene.camera.fov * std::numbers::pi / 360));
}

TEST_F(NoriForks, TheCameraOfEthsIsMirrored) {
  const glm::dvec3 point(0.5, 1.25, 1.0);
  const auto column = [&](const char* dialect) {
    ReadOptions options;
    options.dialect = dialect;
    return pixel_column(good_nori(mesh(""), kPlaced, options), point);
  };
  // By the matrices of both cameras: +x of the camera's space is left in the one, w/2 (1 - cot x/z), and
  // right in the other, w/2 (1 + cot x/z). Their lookat is the same: x = up x direction.
  const glm::dvec3 direction = glm::normalize(glm::dvec3(1, 2, 8));
  const glm::dvec3 left = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), direction));
  const glm::dvec3 from_camera = point - glm::dvec3(0, 0, -5);
  const double slope = glm::dot(from_camera, left) / glm::dot(from_camera, direction);
  const double cot = 1 / std::tan(40 * std::numbers::pi / 360);
  ASSERT_GT(std::abs(100 * cot * slope), 1.0);
  EXPECT_NEAR(column("nori"), 100 * (1 - cot * slope), 1e-9);
  EXPECT_NEAR(column("nori-eth"), 100 * (1 + cot * slope), 1e-9);
}

TEST_F(NoriForks, TheDialectIsToldByWhatOnlyOneHas) {
  const auto dialect = [&](std::string_view content) { return good_nori(content).dialect; };
  EXPECT_THAT(dialect(mesh("")), HasSubstr("nori (nothing in it tells"));
  EXPECT_EQ(dialect(mesh("") + "<integrator type='whitted'/>"),
            "nori (it has an <integrator> of type 'whitted')");
  EXPECT_EQ(dialect(mesh("") + "<mesh type='sphere'/>"), "nori-eth (it has a <mesh> of type 'sphere')");
  EXPECT_THAT(
      dialect(mesh("<bsdf type='diffuse'><texture type='constant_color' name='albedo'><color name='value' "
                   "value='.1,.2,.3'/></texture></bsdf>")),
      HasSubstr("nori-eth"));
  EXPECT_THAT(dialect(mesh("") + "<integrator type='direct_ems'/><emitter type='pointlight'/>"),
              HasSubstr("nori ("));
  ReadOptions options;
  options.dialect = "nori";
  EXPECT_EQ(good_nori(mesh("") + "<mesh type='sphere'/>", kCamera, options).dialect, "nori (by --dialect)");
  options.dialect = "eth";
  EXPECT_THAT(error(nori(mesh("")), options), AllOf(HasSubstr("dialect"), HasSubstr("nori-eth")));
  options.dialect = "nori-eth";
  EXPECT_THAT(error("<scene version=\"3.0.0\"><sensor type=\"perspective\"/></scene>", options),
              AllOf(HasSubstr("--dialect nori-eth is of Nori's scenes"), HasSubstr("Mitsuba XML")));
}

TEST_F(NoriForks, OnesWithAVersionOfMitsubaAreNorisByTheirCamera) {
  const SceneDescription scene =
      good_of(read("<scene version=\"3.0.0\">" + std::string(kPlaced) + mesh("") + "</scene>"));
  EXPECT_THAT(scene.dialect, HasSubstr("nori"));
  EXPECT_EQ(scene.film.width, 200);
}

TEST_F(NoriForks, ConstantsAndImagesAreTextures) {
  const SceneDescription scene = good_nori(
      mesh("<bsdf type='diffuse'><texture type='constant_color' name='albedo'><color name='value' "
           "value='.1,.2,.3'/></texture></bsdf>") +
      mesh("<bsdf type='diffuse'><texture type='png_texture' name='albedo'><string name='fileName' "
           "value='image.pfm'/><vector name='scale' value='2,3'/><vector name='shift' value='0.5 "
           "0.25'/></texture></bsdf>") +
      mesh("<bsdf type='disney'><color name='baseColor' value='.1,.2,.3'/><string name='albedoTexture' "
           "value='image.pfm'/><string name='roughnessMap' value='image.pfm'/></bsdf>") +
      mesh("<bsdf type='diffuse'><diffusemap type='bitmap'><string name='filename' "
           "value='image.pfm'/></diffusemap></bsdf>"));
  EXPECT_EQ(model_of<DiffuseBsdf>(scene, 0).reflectance.value, glm::vec3(0.1f, 0.2f, 0.3f));
  const int image = model_of<DiffuseBsdf>(scene, 1).reflectance.texture;
  ASSERT_GE(image, 0);
  EXPECT_FALSE(texture_of<BitmapTexture>(scene, image).raw);
  // Our v is 1 - v: v = 0.5 is 3 * 0.5 + 0.25 there, and 1 less that here.
  const glm::dvec3 at = scene.textures.at(std::size_t(image)).to_uv * glm::dvec3(0.5, 0.5, 1.0);
  EXPECT_NEAR(at.x, 1.5, 1e-12);
  EXPECT_NEAR(at.y, 1 - 1.75, 1e-12);
  const DisneyBsdf& disney = model_of<DisneyBsdf>(scene, 2);
  ASSERT_GE(disney.base_color.texture, 0);
  ASSERT_GE(disney.roughness.texture, 0);
  EXPECT_TRUE(texture_of<BitmapTexture>(scene, disney.roughness.texture).raw) << "roughness is no colour";
  EXPECT_GE(model_of<DiffuseBsdf>(scene, 3).reflectance.texture, 0);
}

/// Nori's: value1 where floor(u / scale - delta) + floor(v / scale - delta) is even.
TEST_F(NoriForks, CheckerboardsHaveTheirSquares) {
  const SceneDescription scene = good_nori(mesh(
      "<bsdf type='diffuse'><texture type='checkerboard_color' name='albedo'><point name='delta' "
      "value='0.5,0.25'/><vector name='scale' value='0.1,0.2'/><color name='value1' value='.8,.8,.8'/><color "
      "name='value2' value='.2,.2,.2'/></texture></bsdf>"));
  const int index = model_of<DiffuseBsdf>(scene).reflectance.texture;
  ASSERT_GE(index, 0);
  const auto& board = texture_of<CheckerboardTexture>(scene, index);
  for (const glm::dvec2 uv :
       {glm::dvec2(0.03, 0.01), {0.12, 0.01}, {0.12, 0.33}, {0.97, 0.71}, {0.56, 0.94}}) {
    const bool even = int(std::floor(uv.x / 0.1 - 0.5) + std::floor(uv.y / 0.2 - 0.25)) % 2 == 0;
    // Our reader of OBJ files has 1 - v.
    glm::dvec3 at = scene.textures.at(std::size_t(index)).to_uv * glm::dvec3(uv.x, 1 - uv.y, 1);
    at -= glm::floor(at);
    const bool first = (at.x > 0.5) == (at.y > 0.5);
    EXPECT_EQ((first ? board.color0 : board.color1).value, glm::vec3(even ? 0.8f : 0.2f))
        << uv.x << ", " << uv.y;
  }
}

TEST_F(NoriForks, NormalMapsOfMeshesAndOfBsdfs) {
  const char* map =
      "<texture type='normal_map' name='normal'><string name='filename' value='image.pfm'/></texture>";
  const SceneDescription scene = good_nori(mesh(fmt::format("{}<bsdf type='diffuse'/>", map)) +
                                           mesh(fmt::format("<bsdf type='microfacet'>{}</bsdf>", map)));
  for (std::size_t i : {0u, 1u}) {
    const Bsdf& bsdf = scene.bsdfs.at(std::size_t(scene.shapes.at(i).front_bsdf));
    EXPECT_EQ(bsdf.bend.kind, BendKind::kNormalMap);
    ASSERT_GE(bsdf.bend.texture, 0);
    EXPECT_TRUE(texture_of<BitmapTexture>(scene, bsdf.bend.texture).raw);
  }
  EXPECT_TRUE(std::holds_alternative<MicrofacetDiffuseBsdf>(
      scene.bsdfs.at(std::size_t(scene.shapes[1].front_bsdf)).model));
}

TEST_F(NoriForks, LightsByTheirManyNames) {
  const SceneDescription scene =
      good_nori(mesh("") +
                "<emitter type='spotlight'><point name='position' value='0,0,5'/><vector name='direction' "
                "value='0,0,-2'/>"
                "<color name='power' value='3,2,1'/><float name='cosFalloffStart' value='1'/><float "
                "name='cosTotalWidth' "
                "value='0.5'/></emitter>"
                "<emitter type='directional'><vector name='direction' value='-1,0,0'/><color name='power' "
                "value='3,2,1'/></emitter>"
                "<emitter type='pointlight'><point name='position' value='1,2,3'/><color name='radiance' "
                "value='12,3,3'/></emitter>");
  const auto spot = only<SpotLight>(scene);
  EXPECT_NEAR(spot.cutoff_angle, 60.0, 1e-9);
  EXPECT_NEAR(spot.beam_width, 0.0, 1e-9);
  EXPECT_NEAR(spot.intensity.x, 3 / (2 * std::numbers::pi * (1 - 0.5 * 1.5)), 1e-5);
  EXPECT_EQ(spot.falloff, SpotFalloff::kSquared);
  EXPECT_NEAR(spot.to_world[2].z, -1.0, 1e-12) << "along its direction";
  EXPECT_EQ(glm::dvec3(spot.to_world[3]), glm::dvec3(0, 0, 5));
  EXPECT_EQ(only<DirectionalLight>(scene).irradiance, glm::vec3(3, 2, 1));
  EXPECT_EQ(only<PointLight>(scene).intensity, glm::vec3(12, 3, 3));
}

TEST_F(NoriForks, EnvironmentsAndTexturedAreaLights) {
  const SceneDescription map =
      good_nori(mesh("") +
                "<emitter type='environment'><string name='path2map' value='image.pfm'/><float "
                "name='weight' value='2'/></emitter><mesh type='sphere'/>");
  const auto light = only<EnvironmentMapLight>(map);
  EXPECT_EQ(light.scale, 2.0f);
  // ETH's have z up: it is where Mitsuba's images have y.
  const glm::dvec4 up = light.to_world * glm::dvec4(0, 1, 0, 0);
  EXPECT_NEAR(up.z, 1.0, 1e-12);
  EXPECT_THAT(warnings(map), HasSubstr("here z is up"));
  const SceneDescription constant =
      good_nori(mesh("") +
                "<emitter type='envmap'><texture type='constant_color' name='albedo'><color name='value' "
                "value='.1,.2,.3'/></texture></emitter>");
  EXPECT_EQ(only<ConstantEnvironment>(constant).radiance, glm::vec3(0.1f, 0.2f, 0.3f));
  // Some put it on a ball around everything.
  const SceneDescription ball =
      good_nori(mesh("") +
                "<mesh type='sphere'><float name='radius' value='1000'/><emitter type='env_map'><string "
                "name='filename' value='image.pfm'/></emitter></mesh>");
  EXPECT_EQ(ball.shapes.size(), 1u);
  only<EnvironmentMapLight>(ball);
  const SceneDescription area_light = good_nori(
      mesh("<emitter type='area'><texture type='image_texture' name='albedo'><string name='filename' "
           "value='image.pfm'/></texture></emitter>"));
  ASSERT_EQ(area_light.shapes.size(), 1u);
  EXPECT_TRUE(area_light.shapes[0].radiance.has_value());
  EXPECT_GE(area_light.shapes[0].radiance_texture, 0);
}

TEST_F(NoriForks, Lenses) {
  const SceneDescription lens = good_nori(
      mesh(""),
      "<camera type='perspective'><float name='lensRadius' value='0.25'/><float name='focalDistance' "
      "value='80'/></camera>");
  EXPECT_EQ(lens.camera.aperture_radius, 0.25);
  EXPECT_EQ(lens.camera.focus_distance, 80.0);
  EXPECT_EQ(lens.camera.fov, 30.0);
  const SceneDescription pinhole =
      good_nori(mesh(""), "<camera type='advancedCamera'><float name='lensRadius' value='0'/></camera>");
  EXPECT_EQ(pinhole.camera.aperture_radius, 0.0);
  EXPECT_THAT(error(nori(mesh(""), "<camera type='fisheye'/>")), HasSubstr("camera type 'fisheye'"));
}

TEST_F(NoriForks, MediaInShapesAboutTheCameraAndInBoxes) {
  const char* medium =
      "<medium type='homog'><color name='sigma_a' value='2,2,2'/><color name='sigma_s' "
      "value='1,1,1'/>{}<phase "
      "type='anisophase'><float name='g' value='-0.75'/></phase></medium>";
  const std::string plain = fmt::format(fmt::runtime(medium), "");
  const SceneDescription inside =
      good_nori("<integrator type='path_vol_mats'/><shape type='sphere'>" + plain + "</shape>");
  ASSERT_EQ(inside.media.size(), 1u);
  EXPECT_EQ(inside.media[0].extinction, glm::vec3(3.0f));
  ASSERT_EQ(inside.media[0].phase.size(), 1u);
  EXPECT_EQ(inside.media[0].phase[0].g, -0.75f);
  EXPECT_EQ(inside.shapes.at(0).interior, 0);
  EXPECT_TRUE(
      std::holds_alternative<NullBsdf>(inside.bsdfs.at(std::size_t(inside.shapes[0].front_bsdf)).model))
      << "light passes through its boundary";
  EXPECT_EQ(print_setting(inside, "integrator.type"), "volpath_mats");
  const SceneDescription everywhere = good_nori("<integrator type='volpath'/>" + plain + mesh(""));
  EXPECT_EQ(everywhere.camera_medium, 0);
  const SceneDescription box =
      good_nori("<integrator type='vol_path'/>" +
                fmt::format(fmt::runtime(medium),
                            "<vector name='center' value='1 2 3'/><vector name='size' value='.5 .5 .5'/>") +
                mesh(""));
  EXPECT_EQ(box.camera_medium, kNoMedium);
  EXPECT_EQ(box.shapes.size(), 2u);
  EXPECT_THAT(
      error(nori("<medium type='homogeneous'><vector name='size' value='1,0,1'/></medium>" + mesh(""))),
      HasSubstr("the box of the medium must have three sides above 0"));
  EXPECT_THAT(error(nori("<medium type='heterogeneous'/>" + mesh(""))),
              HasSubstr("medium type 'heterogeneous' is not one of Nori's that Penumbra reads"));
}

TEST_F(NoriForks, MediaOfOtherForks) {
  const std::string colours = "<color name='sigmaA' value='.5,.5,.5'/><color name='sigmaS' value='1,1,1'/>";
  const auto medium = [&](const std::string& type, const std::string& content) {
    return "<integrator type='volpath'/><medium type='" + type + "'>" + colours + content + "</medium>" +
           mesh("");
  };
  const auto extent = [&](const std::string& content) {
    const SceneDescription scene = good_nori(medium("medium", content));
    EXPECT_EQ(scene.shapes.size(), 2u) << content;
    glm::dvec3 low(9.0), high(-9.0);
    for (const Shape& shape : scene.shapes)
      if (shape.interior != kNoMedium)
        for (const auto& position : std::get<Mesh>(shape.geometry).positions) {
          low = glm::min(low, position);
          high = glm::max(high, position);
        }
    return std::pair(low, high);
  };
  const std::pair box(glm::dvec3(0.5, 1.5, 2.5), glm::dvec3(1.5, 2.5, 3.5));
  EXPECT_EQ(extent("<vector name='origin' value='1 2 3'/><vector name='dimensions' value='.5 -.5 .5'/>"),
            box);
  EXPECT_EQ(extent("<vector name='box_origin' value='1 2 3'/><vector name='box_size' value='.5 .5 .5'/>"),
            box);
  EXPECT_EQ(extent("<transform name='toWorld'><translate value='.5 1.5 2.5'/></transform>"), box);

  const SceneDescription dense = good_nori(medium(
      "homo",
      "<float name='density_a' value='2'/><float name='density_s' value='3'/><float name='g' value='.25'/>"));
  EXPECT_EQ(dense.media.at(0).extinction, glm::vec3(4.0f));
  EXPECT_EQ(dense.media[0].albedo, glm::vec3(0.75f));
  EXPECT_EQ(dense.media[0].phase.at(0).g, 0.25f);
  const SceneDescription whole = good_nori(
      "<integrator type='volpath'/><medium type='homogeneous'><color name='sigmaS' value='1,1,1'/><color "
      "name='sigmaT' value='4,4,4'/></medium>" +
      mesh(""));
  EXPECT_EQ(whole.media.at(0).extinction, glm::vec3(4.0f));
  EXPECT_EQ(whole.media[0].albedo, glm::vec3(0.25f));
  const SceneDescription scaled =
      good_nori(medium("medium", "<float name='max_density' value='3'/><phase type='iso'/>"));
  EXPECT_EQ(scaled.media.at(0).extinction, glm::vec3(4.5f));
  EXPECT_THAT(warnings(scaled), HasSubstr("max_density multiplies sigma_a and sigma_s"));
  EXPECT_THAT(error(nori(medium("medium", "<integer name='density_function' value='2'/>"))),
              HasSubstr("density_function 2: a density that varies in the medium is not read; 1, the same "
                        "everywhere, is"));
}

TEST_F(NoriForks, InstancesOfASubsceneOrOfTheirOwn) {
  const std::string at = "<transform name='toWorld'><translate value='0,3,0'/></transform>";
  const std::string subscene =
      "<subscene type='subscene'><integer name='id' value='1'/>" + mesh("") + "</subscene>";
  const auto instance = [](const std::string& content) {
    return "<instance type='instance'>" + content + "</instance>";
  };
  const std::string first = "<integer name='subscene' value='1'/>";
  const SceneDescription scene = good_nori(instance(first) + subscene + instance(first + at));
  EXPECT_TRUE(scene.shapes.empty());
  ASSERT_EQ(scene.groups.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[1].to_world[3].y, 3.0);
  const SceneDescription own = good_nori("<shape type='instance'>" + at + "<shape type='sphere'/></shape>");
  EXPECT_EQ(own.groups.size(), 1u);
  EXPECT_EQ(own.instances.size(), 1u);
  EXPECT_THAT(error(nori(subscene + instance("<integer name='subscene' value='2'/>"))),
              HasSubstr("there is no <subscene> of id 2"));
  EXPECT_THAT(error(nori(subscene + subscene)), HasSubstr("there is a <subscene> of id 1 already"));
  EXPECT_THAT(error(nori(instance(""))), HasSubstr("an instance needs a <shape>, or an <integer"));
}

/// Its front is where u × v points: up.
TEST_F(NoriForks, ParallelogramsAreRectangles) {
  const auto parallelogram = [](const char* v) {
    return fmt::format(
        "<mesh type='parallelogram'><string name='name' value='light'/><point name='origin' value='1 2 "
        "3'/><vector "
        "name='u' value='0 0 4'/><vector name='v' value='{}'/><emitter type='parallelogram_emitter'><color "
        "name='radiance' value='4 4 4'/></emitter></mesh>",
        v);
  };
  const SceneDescription scene = good_nori(parallelogram("2 0 0"));
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_EQ(*scene.shapes[0].radiance, glm::vec3(4.0f));
  const Mesh& found = std::get<Mesh>(scene.shapes[0].geometry);
  glm::dvec3 low(9.0), high(-9.0);
  for (const auto& position : found.positions) {
    low = glm::min(low, position);
    high = glm::max(high, position);
  }
  EXPECT_EQ(low, glm::dvec3(1, 2, 3));
  EXPECT_EQ(high, glm::dvec3(3, 2, 7));
  const glm::uvec3& corners = found.triangles.at(0);
  EXPECT_GT(glm::cross(found.positions[corners.y] - found.positions[corners.x],
                       found.positions[corners.z] - found.positions[corners.x])
                    .y *
                (scene.shapes[0].flip_normals ? -1 : 1),
            0);
  EXPECT_THAT(error(nori(parallelogram("0 0 1"))),
              HasSubstr("u and v of a parallelogram must not be parallel"));
}

TEST_F(NoriForks, LightsOfOtherForks) {
  const auto light = [&](const std::string& content) { return good_nori(mesh("") + content); };
  const SceneDescription strong =
      good_nori(mesh("<emitter type='area'><color name='radiance' value='1 2 3'/><float name='strength' "
                     "value='5'/></emitter>"));
  EXPECT_EQ(*strong.shapes.at(0).radiance, glm::vec3(5, 10, 15));
  const SceneDescription high = light(
      "<emitter type='directional'><color name='radiance' value='1 1 1'/><float name='strength' "
      "value='2'/><float name='theta' value='30'/><float name='phi' value='90'/></emitter>");
  const auto sun = only<DirectionalLight>(high);
  EXPECT_EQ(sun.irradiance, glm::vec3(2.0f));
  EXPECT_LT(glm::length(glm::dvec3(sun.direction) - glm::dvec3(0, -0.5, std::sqrt(0.75))), 1e-6);
  const SceneDescription image = light(
      "<emitter type='IBL'><string name='exr_path' value='image.pfm'/><float name='strength' "
      "value='.5'/></emitter>");
  EXPECT_EQ(only<EnvironmentMapLight>(image).to_world, glm::dmat4(1.0)) << "its y is up";
  const SceneDescription degrees = light(
      "<emitter type='spotlight'><point name='position' value='0,0,1'/><vector name='direction' "
      "value='0,0,-1'/>"
      "<color name='color' value='1,1,1'/><float name='cosTotalWidth' value='50'/><float "
      "name='cosFalloffStart' "
      "value='13'/></emitter>");
  EXPECT_EQ(only<SpotLight>(degrees).cutoff_angle, 50.0) << "no cosine";
}

TEST_F(NoriForks, MaterialsOfOtherForks) {
  const SceneDescription metal =
      good_nori(mesh("<bsdf type='conductor'><string name='materialName' value='Cu'/></bsdf>"));
  EXPECT_TRUE(metal.warnings.empty()) << warnings(metal);
  const SceneDescription flat = good_nori(mesh(
      "<bsdf type='disney'><float name='flatness' value='.5'/><float name='specTrans' value='0'/></bsdf>"));
  EXPECT_EQ(model_of<DisneyBsdf>(flat).subsurface.value, 0.5f);
  EXPECT_TRUE(flat.warnings.empty()) << warnings(flat);
  EXPECT_THAT(error(nori(mesh("<bsdf type='disney'><float name='specTrans' value='.5'/></bsdf>"))),
              HasSubstr("spec_trans of Nori's Disney BSDF is read if it is 0"));
  model_of<NullBsdf>(good_nori(mesh("<bsdf type='nullBSDF'/>")));
}

TEST_F(NoriForks, IntegratorsOfOtherWaysToTheSameImage) {
  const auto type = [&](const char* name, std::string_view expected_warning) {
    const SceneDescription scene = good_nori(
        mesh("") +
        fmt::format("<integrator type='{}'><integer name='photonCount' value='9'/></integrator>", name));
    EXPECT_THAT(warnings(scene), HasSubstr(std::string(expected_warning)));
    return print_setting(scene, "integrator.type");
  };
  EXPECT_EQ(type("bdpt", "path_mis stands in for the integrator 'bdpt'"), "path_mis");
  EXPECT_EQ(type("volumetric_bdpt", "volpath stands in"), "volpath");
  EXPECT_EQ(type("path_tracer_mats", "path_mats stands in"), "path_mats");
  EXPECT_THAT(error(nori(mesh("") + "<integrator type='wireframe'/>")),
              HasSubstr("integrator type 'wireframe'"));
}

TEST_F(NoriForks, PhotonMapsOfOneRadius) {
  const auto map = [&](const char* name, std::string_view inside) {
    const SceneDescription scene =
        good_nori(mesh("") + fmt::format("<integrator type='{}'>{}</integrator>", name, inside));
    EXPECT_THAT(warnings(scene), Not(HasSubstr("integrator"))) << name;
    const auto* found = scene.integrator.get<PhotonMapIntegrator>();
    EXPECT_NE(found, nullptr) << name;
    return found != nullptr ? *found : PhotonMapIntegrator{};
  };
  const PhotonMapIntegrator plain = map("photonmapper", "");
  for (const int photons : {plain.global_photons, plain.caustic_photons, plain.volume_photons})
    EXPECT_EQ(photons, 1'000'000);
  EXPECT_EQ(plain.photon_radius, 0.0f);
  // 1/500 of the diagonal of a box, in half diagonals.
  for (const float radius :
       {plain.global_lookup_radius, plain.caustic_lookup_radius, plain.volume_lookup_radius})
    EXPECT_EQ(radius, 0.004f);
  EXPECT_EQ(plain.lookup_size, MAX_PHOTONS) << "all photons within the radius";
  for (const char* name : {"photonmapper", "photon_mapper", "photon_mapping", "photo_mapper",
                           "volumetricphotonmapper", "pmap"}) {
    const PhotonMapIntegrator given =
        map(name, "<integer name='photonCount' value='5000'/><float name='photonRadius' value='0.25'/>");
    for (const int photons : {given.global_photons, given.caustic_photons, given.volume_photons})
      EXPECT_EQ(photons, 5000) << name;
    EXPECT_EQ(given.photon_radius, 0.25f) << name;
  }
  EXPECT_EQ(map("photon_mapper", "<float name='radius' value='2'/>").photon_radius, 2.0f);
  EXPECT_THAT(error(nori(mesh("") + "<integrator type='photonmapper'><integer name='photonCount' "
                                    "value='1000000000'/></integrator>")),
              AllOf(HasSubstr("global_photons"), HasSubstr("from 0 to 16777216")));
}

TEST_F(NoriForks, ProgressivePhotonMaps) {
  const auto progressive = [&](const char* name, std::string_view inside) {
    const SceneDescription scene =
        good_nori(mesh("") + fmt::format("<integrator type='{}'>{}</integrator>", name, inside));
    const auto* found = scene.integrator.get<ProgressivePhotonIntegrator>();
    EXPECT_NE(found, nullptr) << name;
    return std::pair(found != nullptr ? *found : ProgressivePhotonIntegrator{}, warnings(scene));
  };
  for (const char* name :
       {"pppm", "ppm", "sppm", "photon_ppm", "progressivephotonmapper", "progressive_photonmapper"}) {
    const auto [plain, no_warnings] = progressive(name, "");
    EXPECT_EQ(plain.photon_count, 250'000) << name;
    EXPECT_EQ(plain.initial_radius, 0.0f) << name;
    EXPECT_EQ(plain.alpha, 0.7f) << name;
    EXPECT_THAT(no_warnings, Not(HasSubstr("ignored")));
    const auto [given, one_warning] = progressive(
        name,
        "<integer name='photonCount' value='5000'/><float name='photonRadius' value='0.25'/><float "
        "name='alpha' value='0.5'/><integer name='iterations' value='20'/>");
    EXPECT_EQ(given.photon_count, 5000) << name;
    EXPECT_EQ(given.initial_radius, 0.25f) << name;
    EXPECT_EQ(given.alpha, 0.5f) << name;
    EXPECT_THAT(one_warning, AllOf(HasSubstr("iterations is ignored"), HasSubstr("samples per pixel")));
  }
  const auto [other, warned] =
      progressive("sppm",
                  "<integer name='PhotonCount' value='5000'/><float name='radius' value='0.25'/><float "
                  "name='photonAlpha' value='0.5'/><integer name='numIterations' value='20'/>");
  EXPECT_EQ(other.photon_count, 5000);
  EXPECT_EQ(other.initial_radius, 0.25f);
  EXPECT_EQ(other.alpha, 0.5f);
  EXPECT_THAT(warned, HasSubstr("num_iterations is ignored"));
}

TEST_F(NoriForks, NormalsSimpleAndMaterial) {
  const SceneDescription normals = good_of(read(nori(mesh("") + "<integrator type='normals'/>")));
  EXPECT_EQ(print_setting(normals, "integrator.type"), "normals");
  EXPECT_TRUE(normals.warnings.empty()) << "it needs no light";
  const SceneDescription simple =
      good_nori(mesh("<bsdf type='mirror'/><emitter type='area'/>") +
                "<integrator type='simple'><point name='position' value='-20,40,20'/><color name='energy' "
                "value='3000,3000,3000'/></integrator>");
  const auto light = only<PointLight>(simple);
  EXPECT_EQ(light.position, glm::dvec3(-20, 40, 20));
  EXPECT_NEAR(light.intensity.x, 3000 / (4 * std::numbers::pi), 1e-3);
  EXPECT_EQ(model_of<DiffuseBsdf>(simple).reflectance.value, glm::vec3(1.0f))
      << "energy / (4 pi^2) cos / r^2";
  EXPECT_FALSE(simple.shapes.at(0).radiance.has_value());
  const SceneDescription material =
      good_nori(mesh("<bsdf type='diffuse'><color name='albedo' value='.5,.25,0'/></bsdf>") +
                mesh("<bsdf type='mirror'/>") + "<integrator type='material'/><emitter type='point'/>");
  ASSERT_TRUE(material.shapes.at(0).radiance.has_value());
  EXPECT_NEAR(material.shapes[0].radiance->x, 0.5 / std::numbers::pi, 1e-6);
  EXPECT_FALSE(material.shapes.at(1).radiance.has_value());
  EXPECT_TRUE(material.emitters.empty());
}

class NoriTests : public NoriForks {
 protected:
  static std::string scene_of(std::string_view albedo) {
    return nori(
        mesh(fmt::format("<bsdf type='diffuse'><color name='albedo' value='{0},{0},{0}'/></bsdf>", albedo)));
  }
};

TEST_F(NoriTests, OneOfTheScenesIsRendered) {
  const std::string text = "<test type='ttest'><string name='references' value='0.1, 0.2'/>" +
                           scene_of("0.1") + scene_of("0.2") + "</test>";
  const SceneDescription first = good_of(read(text));
  EXPECT_EQ(model_of<DiffuseBsdf>(first).reflectance.value, glm::vec3(0.1f));
  EXPECT_THAT(warnings(first),
              HasSubstr("scene 1 of the 2 of a <test> is rendered; its mean should be 0.1; -D scene=N"));
  EXPECT_EQ(first.film.filter, FilterKind::kBox);
  EXPECT_EQ(first.sampler.spp, 100'000u);
  const SceneDescription second = good_of(read(text, {.defines = {{"scene", "2"}}}));
  EXPECT_EQ(model_of<DiffuseBsdf>(second).reflectance.value, glm::vec3(0.2f));
  EXPECT_THAT(error(text, {.defines = {{"scene", "3"}}}),
              HasSubstr("there is no scene 3 in the <test>, which has 2"));
  EXPECT_THAT(error(text, {.defines = {{"scene", "x"}}}), HasSubstr("scenes have numbers from 1 on"));
  EXPECT_THAT(error(text, {.defines = {{"n", "1"}}}), HasSubstr("a Nori scene has no variables"));
  EXPECT_THAT(error("<test type='ttest'/>"), HasSubstr("nothing to render"));
}

TEST_F(NoriTests, OfBsdfsAPlaneIsRenderedAtEachAngle) {
  const std::string text =
      "<test type='ttest'><string name='angles' value='0, 45'/><string name='references' value='0.25, 0.5'/>"
      "<bsdf type='microfacet'><float name='alpha' value='0.1'/></bsdf></test>";
  const SceneDescription scene = good_of(read(text, {.defines = {{"scene", "2"}}}));
  EXPECT_EQ(scene.film.width, 1);
  EXPECT_EQ(model_of<MicrofacetDiffuseBsdf>(scene).alpha, 0.1f);
  const glm::dvec3 view(scene.camera.to_world[2]);
  EXPECT_NEAR(view.z, -std::sqrt(0.5), 1e-9);
  EXPECT_EQ(only<ConstantEnvironment>(scene).radiance, glm::vec3(1.0f));
  EXPECT_THAT(warnings(scene),
              AllOf(HasSubstr("scene 2 of the 2"), HasSubstr("at 45 degrees"), HasSubstr("should be 0.5")));
  EXPECT_EQ(
      good_of(read("<test type='chi2test'><bsdf type='diffuse'/><bsdf type='mirror'/></test>")).film.width,
      1);
}

}  // namespace
}  // namespace penumbra
