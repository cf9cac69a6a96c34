// The XML of Mitsuba's format: versions, variables, includes, paths, references, values, transforms.
#include <gmock/gmock.h>

#include "scenes/spectrum.h"
#include "tests/scenes/scene_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using MitsubaXml = SceneText;

/// A point light that shows a value: its intensity, or where its transform puts it.
std::string light(std::string_view inside) {
  return "<emitter type=\"point\">" + std::string(inside) + "</emitter>";
}
std::string placed(std::string_view steps) {
  return light("<transform name=\"to_world\">" + std::string(steps) + "</transform>");
}

TEST_F(MitsubaXml, Versions) {
  for (const char* version : {"0.4.0", "0.5.0", "0.6.0", "2.1.0", "3.0.0", "3.9", "3"}) {
    EXPECT_TRUE(read("<scene version='" + std::string(version) + "'><sensor type='perspective'/></scene>"))
        << version;
  }
  EXPECT_EQ(error("<scene><sensor type='perspective'/></scene>"),
            "scene.xml:1:2: error: <scene> needs the attribute 'version'\n  <scene><sensor "
            "type='perspective'/></scene>\n"
            "   ^");
  for (const char* version : {"4.0.0", "0.3.0"}) {
    EXPECT_THAT(error("<scene version='" + std::string(version) + "'/>"), HasSubstr("0.4 to 3.x"));
  }
  for (const char* version : {"", "three", "3.", "3.0.0.0", "-3.0", "3.x"}) {
    EXPECT_THAT(error("<scene version='" + std::string(version) + "'/>"),
                HasSubstr("is not a version such as 3.0.0"));
  }
}

TEST_F(MitsubaXml, DefaultsAndDefines) {
  const std::string text =
      "<default name='x' value='3'/><default name='xy' value='7'/><default name='x' value='4'/>" +
      light("<rgb name='intensity' value='$x ${}'/>");
  const auto with = [&](std::string_view value, const ReadOptions& options) {
    std::string filled = text;
    filled.replace(filled.find("$x ${}"), 6, value);
    const SceneDescription result = good(filled, options);
    return result.emitters.empty() ? glm::vec3(-1) : only<PointLight>(result).intensity;
  };
  EXPECT_EQ(with("$x", {}), glm::vec3(3));
  EXPECT_EQ(with("$x $xy 1$x", {}), glm::vec3(3, 7, 13));
  EXPECT_EQ(with("$x1", {}), glm::vec3(31));  // there is no x1
  EXPECT_EQ(with("$x", {.defines = {{"x", "5"}}}), glm::vec3(5));
  EXPECT_EQ(with("$new", {.defines = {{"new", "6"}}}), glm::vec3(6));
}

TEST_F(MitsubaXml, VariablesInAnyAttribute) {
  const SceneDescription result = good(
      "<default name='kind' value='sphere'/><default name='what' value='radius'/><default name='id' "
      "value='i'/>"
      "<default name='axis' value='7'/><shape type='$kind' id='$id'><float name='$what' value='2'/>"
      "<transform name='to_world'><translate x='$axis'/></transform></shape>");
  ASSERT_THAT(result.shapes, SizeIs(1));
  EXPECT_EQ(result.shapes[0].name, "i");
  EXPECT_EQ(std::get<Sphere>(result.shapes[0].geometry).radius, 2.0);
  EXPECT_EQ(std::get<Sphere>(result.shapes[0].geometry).center.x, 7.0);
}

TEST_F(MitsubaXml, UndefinedVariablesAndUnusedDefines) {
  EXPECT_EQ(error(scene("<default name='depth' value='1'/>\n<shape type='$dpeth'/>")),
            "scene.xml:3:14: error: $dpeth is not defined; did you mean 'depth'? Give it a <default> before "
            "its use, or "
            "-D dpeth=…\n  <shape type='$dpeth'/>\n               ^");
  EXPECT_THAT(error(scene("<default name='a b' value='1'/>")), HasSubstr("letters, digits and underscores"));
  EXPECT_THAT(error(scene("<default name='spp' value='1'/>"), {.defines = {{"sp", "2"}}}),
              HasSubstr("error: -D sp=2: the scene uses no $sp; did you mean 'spp'? It uses: spp"));
}

TEST_F(MitsubaXml, VariablesCannotGrowWithoutBound) {
  std::string text = "<default name='a0' value='aaaaaaaaaaaaaaaa'/>\n";
  for (int i = 1; i < 60; ++i) {
    const std::string before = "$a" + std::to_string(i - 1);
    text += "<default name='a" + std::to_string(i) + "' value='" + before + before + "'/>\n";
  }
  EXPECT_THAT(error(scene(text)),
              HasSubstr("too long once its variables are filled in: with $a16, of 1048576"));
}

TEST_F(MitsubaXml, NorCanAllOfThemTogether) {
  std::string text = "<default name='long' value='" + std::string(500000, 'x') + "'/>\n";
  for (int i = 0; i < 100; ++i) text += "<default name='a" + std::to_string(i) + "' value='$long'/>\n";
  EXPECT_THAT(
      error(scene(text)),
      HasSubstr("scene.xml:36:28: error: the scene's texts are together too long once their variables are "
                "filled in: with $long, of 500000 bytes, more than 16777216"));
}

TEST_F(MitsubaXml, IdsHaveALength) {
  const std::string longest(1024, 'i');
  EXPECT_TRUE(read(scene("<bsdf type='diffuse' id='" + longest + "'/>")));
  EXPECT_THAT(error(scene("<bsdf type='diffuse' id='" + longest + "i'/>")),
              HasSubstr("scene.xml:2:26: error: this id has 1025 bytes; the most that are read are 1024"));
  std::string text = "<default name='long' value='" + longest + "'/>\n";
  for (int i = 0; i < 2000; ++i) text += "<shape type='sphere' id='" + std::to_string(i) + "$long'/>\n";
  EXPECT_THAT(error(scene(text)), HasSubstr("scene.xml:3:26: error: this id has 1025 bytes"));
  EXPECT_THAT(error(scene("<bsdf type='diffuse' id='a'/><alias id='a' as='" + longest + "i'/>")),
              HasSubstr("this id has 1025 bytes"));
  EXPECT_THAT(error(scene("<include filename='" + std::string(5000, 'f') + "'/>")),
              HasSubstr("the file name has 5000 bytes; the most that are read are 4096"));
}

TEST_F(MitsubaXml, Includes) {
  std::filesystem::create_directory(folder_ / "parts");
  write("parts/lights.xml",
        "<scene version='2.0.0'><include filename='more.xml'/><include filename='top.xml'/></scene>");
  write("parts/more.xml",
        "<scene version='2.0.0'>" + light("<rgb name='intensity' value='$c'/>") + "</scene>");
  write("top.xml", "<scene version='2.0.0'><bsdf type='diffuse' id='late'/></scene>");
  const SceneDescription result = good(
      "<default name='c' value='8'/><shape type='sphere'><ref id='late'/></shape>"
      "<include filename='parts/lights.xml'/>");
  EXPECT_EQ(only<PointLight>(result).intensity, glm::vec3(8));
}

TEST_F(MitsubaXml, CyclicIncludesShowTheChain) {
  write("a.xml", "<scene version='3.0.0'><include filename='b.xml'/></scene>");
  write("b.xml", "<scene version='3.0.0'>\n<include filename='a.xml'/></scene>");
  const std::string message = error(scene("<include filename='a.xml'/>"));
  EXPECT_THAT(message, AllOf(HasSubstr("b.xml:2:20: error: the file includes itself: a.xml → b.xml → a.xml"),
                             HasSubstr("<include filename='a.xml'/>")));
  EXPECT_THAT(error(scene("<include filename='scene.xml'/>")), HasSubstr("scene.xml → scene.xml"));
}

TEST_F(MitsubaXml, IncludesThatDoubleAtEveryLevelAreStopped) {
  for (int i = 0; i < 12; ++i) {
    const std::string next = "<include filename='" + std::to_string(i + 1) + ".xml'/>";
    write(std::to_string(i) + ".xml", "<scene version='3.0.0'>" + next + next + "</scene>");
  }
  write("12.xml", "<scene version='3.0.0'/>");
  EXPECT_THAT(error(scene("<include filename='0.xml'/>")), HasSubstr("too many includes"));
}

TEST_F(MitsubaXml, SearchPaths) {
  std::filesystem::create_directories(folder_ / "common/meshes");
  write("common/meshes/t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const SceneDescription result =
      good("<path value='common'/><shape type='obj'><string name='filename' value='meshes/t.obj'/></shape>");
  EXPECT_THAT(result.shapes, SizeIs(1));
  EXPECT_THAT(warnings(good("<path value='nowhere'/>")), HasSubstr("there is no folder 'nowhere'"));
  EXPECT_THAT(error(scene("<path value='common/meshes/t.obj'/>")), HasSubstr("is not a folder"));
}

TEST_F(MitsubaXml, PathsOfIncludedFilesAreThoseOfTheMainOneToo) {
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const char* name : {"common", "scenes", "scenes/include", "scenes/include/own"})
    std::filesystem::create_directory(folder_ / name);
  write("common/t.obj", mesh);
  write("scenes/include/own/u.obj", mesh);
  write("scenes/include/part.xml",
        "<scene version='3.0.0'><path value='../common'/><path value='own'/>"
        "<shape type='obj'><string name='filename' value='t.obj'/></shape>"
        "<shape type='obj'><string name='filename' value='u.obj'/></shape></scene>");
  write("scenes/main.xml", scene("<include filename='include/part.xml'/>"));
  const auto read = read_scene(folder_ / "scenes/main.xml", {});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_THAT(read->shapes, SizeIs(2));
}

/// As on the systems that many scenes come from.
TEST_F(MitsubaXml, BackSlashesAndTheCaseOfLettersInPaths) {
  for (const char* name : {"Meshes", "Meshes/Old"}) std::filesystem::create_directory(folder_ / name);
  write("Meshes/Old/T.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto with = [&](const std::string& name) {
    return "<shape type='obj'><string name='filename' value='" + name + "'/></shape>";
  };
  EXPECT_THAT(good(with("Meshes/Old/T.obj")).warnings, ::testing::IsEmpty());
  for (const char* name : {"Meshes\\Old\\T.obj", "meshes/OLD/t.OBJ", ".\\meshes\\old\\t.obj"}) {
    const SceneDescription s = good(with(name) + with(name));
    EXPECT_THAT(s.shapes, SizeIs(2)) << name;
    EXPECT_THAT(s.warnings, ElementsAre(AllOf(HasSubstr("'" + std::string(name) + "' is found as '"),
                                              HasSubstr("Meshes/Old/T.obj'"))));
  }
  EXPECT_THAT(error(scene(with("meshes\\new\\t.obj"))), HasSubstr("there is no file"));
  std::filesystem::create_directory(folder_ / "job");
  write("job/scene.xml", scene(with("..\\meshes\\old\\t.obj")));
  EXPECT_TRUE(read_scene(folder_ / "job/scene.xml", {}));
  EXPECT_FALSE(read_scene(folder_ / "job/scene.xml", {.confine_to = folder_ / "job"}));
  // Nor through a link of another case.
  std::filesystem::create_directory_symlink(folder_ / "Meshes", folder_ / "job/Link");
  write("job/scene.xml", scene(with("link/old/t.obj")));
  EXPECT_TRUE(read_scene(folder_ / "job/scene.xml", {}));
  EXPECT_FALSE(read_scene(folder_ / "job/scene.xml", {.confine_to = folder_ / "job"}));
}

TEST_F(MitsubaXml, PointersOfGitLfsAreNamed) {
  write("t.obj", "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n");
  EXPECT_THAT(error(scene("<shape type='obj'><string name='filename' value='t.obj'/></shape>")),
              HasSubstr("t.obj' is a pointer of Git LFS, not the file itself: `git lfs pull` brings that"));
}

TEST_F(MitsubaXml, Confinement) {
  std::filesystem::create_directory(folder_ / "job");
  write("secret.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("job/inside.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  std::filesystem::create_symlink(folder_ / "secret.obj", folder_ / "job/link.obj");
  const ReadOptions confined{.confine_to = folder_ / "job"};
  const auto with = [&](const std::string& name) {
    write("job/scene.xml", scene("<shape type='obj'><string name='filename' value='" + name + "'/></shape>"));
    return read_scene(folder_ / "job/scene.xml", confined);
  };
  EXPECT_TRUE(with("inside.obj"));
  EXPECT_TRUE(with("../job/inside.obj"));
  for (const std::string& name :
       {std::string("../secret.obj"), (folder_ / "secret.obj").string(), std::string("link.obj"),
        std::string("/etc/passwd"), std::string("../../../../../../etc/passwd"),
        std::string("../nowhere.obj")}) {
    const auto result = with(name);
    ASSERT_FALSE(result) << name;
    EXPECT_THAT(result.error().message, HasSubstr("leads outside the folder")) << name;
  }
  for (const char* element : {"<include filename='../x.xml'/>", "<path value='..'/>"}) {
    write("job/scene.xml", scene(element));
    EXPECT_THAT(read_scene(folder_ / "job/scene.xml", confined).error().message,
                HasSubstr("leads outside the folder"));
  }
  EXPECT_THAT(read_scene(folder_ / "secret.obj", confined).error().message, HasSubstr("outside the folder"));
}

TEST_F(MitsubaXml, ReferencesAndAliases) {
  const SceneDescription result = good(
      "<shape type='sphere'><ref id='other'/></shape>"
      "<shape type='sphere'><ref name='bsdf' id='red'/><ref id='glow'/></shape>"
      "<bsdf type='diffuse' id='red'><rgb name='reflectance' value='1 0 0'/></bsdf>"
      "<alias id='red' as='other'/>"
      "<emitter type='area' id='glow'><rgb name='radiance' value='5'/></emitter>");
  ASSERT_THAT(result.shapes, SizeIs(2));
  EXPECT_EQ(result.bsdfs.size(), 1u);
  EXPECT_EQ(result.shapes[0].front_bsdf, result.shapes[1].front_bsdf);
  EXPECT_EQ(result.bsdfs[0].name, "red");
  EXPECT_FALSE(result.shapes[0].radiance);
  EXPECT_EQ(result.shapes[1].radiance, glm::vec3(5));
}

TEST_F(MitsubaXml, ReferenceErrors) {
  EXPECT_THAT(
      error(scene("<bsdf type='diffuse' id='white'/>\n<shape type='sphere'><ref id='whiet'/></shape>")),
      HasSubstr("scene.xml:3:31: error: there is no object with the id 'whiet'; did you mean 'white'?"));
  EXPECT_THAT(
      error(scene("<bsdf type='diffuse' id='a'/>\n<bsdf type='phong' id='a'/>")),
      AllOf(HasSubstr("scene.xml:3:24: error: the id 'a' is taken: first at "), HasSubstr("scene.xml:2:2")));
  EXPECT_THAT(error(scene("<alias id='none' as='b'/>")), HasSubstr("there is no object with the id 'none'"));
  EXPECT_THAT(error(scene("<bsdf type='twosided' id='a'><ref id='b'/></bsdf><bsdf type='twosided' "
                          "id='b'><ref id='a'/></bsdf>")),
              HasSubstr("holds itself, through its references"));
}

TEST_F(MitsubaXml, CamelCaseAndSnakeCaseAreTheSame) {
  write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  const std::string snake =
      "<integrator type='path'><integer name='max_depth' value='7'/><integer name='rr_depth' value='3'/>"
      "<boolean name='hide_emitters' value='true'/><boolean name='strict_normals' value='true'/></integrator>"
      "<sensor type='perspective'><float name='near_clip' value='.5'/><float name='far_clip' value='99'/>"
      "<string name='fov_axis' value='y'/><float name='fov' value='33'/><float name='focus_distance' "
      "value='3'/>"
      "<transform name='to_world'><lookat origin='0 0 5' target='0 0 0' up='0 1 0'/></transform>"
      "<sampler type='independent'><integer name='sample_count' value='9'/></sampler>"
      "<film type='hdrfilm'><integer name='width' value='64'/><integer name='height' value='48'/>"
      "<integer name='crop_offset_x' value='8'/><integer name='crop_offset_y' value='4'/>"
      "<integer name='crop_width' value='16'/><integer name='crop_height' value='12'/>"
      "<string name='pixel_format' value='rgb'/></film></sensor>"
      "<shape type='obj'><string name='filename' value='t.obj'/><boolean name='face_normals' value='true'/>"
      "<boolean name='flip_normals' value='true'/><transform name='to_world'><scale value='2'/></transform>"
      "<bsdf type='phong'><rgb name='diffuse_reflectance' value='.1'/><rgb name='specular_reflectance' "
      "value='.7'/>"
      "<float name='exponent' value='12'/></bsdf></shape>";
  std::string camel;
  for (std::size_t i = 0; i < snake.size(); ++i) {
    const bool joint = snake[i] == '_' && i + 1 < snake.size();
    camel += joint ? static_cast<char>(std::toupper(snake[++i])) : snake[i];
  }
  camel.replace(camel.find("lookat"), 6, "lookAt");
  const SceneDescription a = good(snake), b = good(camel);
  for (const SceneDescription* s : {&a, &b}) {
    EXPECT_EQ(param::max_depth(s->integrator), 7);
    EXPECT_EQ(param::rr_depth(s->integrator), 3);
    EXPECT_TRUE(s->integrator.hide_emitters);
    EXPECT_EQ(s->camera.near_clip, 0.5);
    EXPECT_EQ(s->camera.far_clip, 99.0);
    EXPECT_EQ(s->camera.fov_axis, FovAxis::kY);
    EXPECT_EQ(s->camera.to_world[3], glm::dvec4(0, 0, 5, 1));
    EXPECT_EQ(s->sampler.spp, 9u);
    EXPECT_EQ(s->film.crop_x, 8);
    EXPECT_EQ(s->film.crop_y, 4);
    EXPECT_EQ(s->film.crop_width, 16);
    EXPECT_EQ(s->film.crop_height, 12);
    ASSERT_THAT(s->shapes, SizeIs(1));
    EXPECT_TRUE(s->shapes[0].flip_normals);
    EXPECT_TRUE(std::get<Mesh>(s->shapes[0].geometry).normals.empty());
    const PhongBsdf& phong = std::get<PhongBsdf>(s->bsdfs.at(0).model);
    EXPECT_EQ(phong.exponent, 12.0f);
    EXPECT_EQ(phong.specular, glm::vec3(0.7f));
  }
}

TEST_F(MitsubaXml, TransformsComposeInOrder) {
  const auto at = [&](std::string_view steps) { return only<PointLight>(good(placed(steps))).position; };
  EXPECT_EQ(at("<translate x='1'/><scale value='2'/>"), glm::dvec3(2, 0, 0));
  EXPECT_EQ(at("<scale value='2'/><translate x='1'/>"), glm::dvec3(1, 0, 0));
  EXPECT_EQ(at("<translate value='1, 2 3'/><rotate z='1' angle='90'/>"), glm::dvec3(-2, 1, 3));
  EXPECT_EQ(at("<translate x='1' z='1'/><rotate value='0 1 0' angle='90'/><scale x='3' y='4'/>"),
            glm::dvec3(3, 0, -1));
  EXPECT_EQ(at("<matrix value='1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1'/><scale value='1 2 3'/>"),
            glm::dvec3(5, 12, 21));
  EXPECT_EQ(at("<translate x='1'/><matrix value='0 1 0  1 0 0  0 0 2'/>"), glm::dvec3(0, 1, 0));
  EXPECT_EQ(at("<lookat origin='1 2 3' target='1 2 9' up='0 1 0'/>"), glm::dvec3(1, 2, 3));
}

TEST_F(MitsubaXml, TransformErrors) {
  const auto message = [&](std::string_view steps) { return error(scene(placed(steps))); };
  EXPECT_THAT(message("<scale x='0'/>"), HasSubstr("the transform is singular"));
  EXPECT_THAT(message("<scale value='1e308'/><scale value='1e308'/>"), HasSubstr("overflows"));
  EXPECT_THAT(message("<matrix value='1 2 3'/>"), HasSubstr("16 numbers (or 9), row by row, not 3"));
  EXPECT_THAT(message("<rotate angle='90'/>"), HasSubstr("needs an axis"));
  EXPECT_THAT(message("<rotate x='1'/>"), HasSubstr("needs the attribute 'angle'"));
  EXPECT_THAT(message("<lookat origin='0 0 0' target='0 0 0' up='0 1 0'/>"), HasSubstr("same point"));
  EXPECT_THAT(message("<lookat origin='0 0 0' target='0 5 0' up='0 1 0'/>"), HasSubstr("along the view"));
  EXPECT_THAT(message("<lookat origin='0 0 0' up='0 1 0'/>"), HasSubstr("needs the attribute 'target'"));
  EXPECT_THAT(message("<translat x='1'/>"), HasSubstr("did you mean 'translate'?"));
  EXPECT_THAT(message("<translate w='1'/>"), HasSubstr("<translate> has no attribute 'w'"));
  EXPECT_THAT(message("<translate value='1 2 3' x='1'/>"), HasSubstr("not both"));
  EXPECT_THAT(message("<translate x='nan'/>"), HasSubstr("not a finite number"));
  EXPECT_THAT(message("<scale value='1 2'/>"), HasSubstr("one or three numbers are wanted, not 2"));
}

TEST_F(MitsubaXml, Colours) {
  const auto colour = [&](std::string_view element) {
    return only<PointLight>(good(light(element))).intensity;
  };
  EXPECT_EQ(colour("<rgb name='intensity' value='1, 2, 3'/>"), glm::vec3(1, 2, 3));
  EXPECT_EQ(colour("<rgb name='intensity' value='1 2 3'/>"), glm::vec3(1, 2, 3));
  EXPECT_EQ(colour("<rgb name='intensity' value='4'/>"), glm::vec3(4));
  EXPECT_EQ(colour("<float name='intensity' value='4'/>"), glm::vec3(4));
  EXPECT_EQ(colour("<rgb name='intensity' value='#ff0000'/>"), glm::vec3(1, 0, 0));
  EXPECT_NEAR(colour("<srgb name='intensity' value='#808080'/>").x, 0.2158605f, 1e-6f);
  EXPECT_NEAR(colour("<srgb name='intensity' value='0.5'/>").y, 0.2140411f, 1e-6f);
  EXPECT_EQ(colour("<spectrum name='intensity' value='1 2 3'/>"), glm::vec3(1, 2, 3));
  EXPECT_EQ(colour("<spectrum name='intensity' value='2'/>"), emission_to_rgb(2));
  EXPECT_GT(colour("<spectrum name='intensity' value='400:0, 500:8, 600:15.6, 700:18.4'/>").x, 20.0f);
  const auto reflectance = [&](std::string_view element) {
    const SceneDescription s =
        good("<shape type='sphere'><bsdf type='diffuse'>" + std::string(element) + "</bsdf></shape>");
    return std::get<DiffuseBsdf>(s.bsdfs.at(0).model).reflectance;
  };
  EXPECT_EQ(reflectance("<spectrum name='reflectance' value='0.25'/>"), glm::vec3(0.25f));
  EXPECT_EQ(reflectance("<spectrum name='reflectance' value='300:1 900:1'/>"), glm::vec3(1));
}

TEST_F(MitsubaXml, ColourErrors) {
  const auto message = [&](std::string_view element) { return error(scene(light(element))); };
  EXPECT_THAT(message("<rgb name='intensity' value='1, 2'/>"), HasSubstr("one or three numbers, not 2"));
  EXPECT_THAT(message("<rgb name='intensity' value='1, 2, -3'/>"), HasSubstr("must be 0 or more"));
  EXPECT_THAT(message("<rgb name='intensity' value='1e39'/>"), HasSubstr("0 or more and finite"));
  EXPECT_THAT(message("<rgb name='intensity' value='#ff00'/>"), HasSubstr("#rrggbb"));
  EXPECT_THAT(message("<rgb name='intensity' value='#gg0000'/>"), HasSubstr("#rrggbb"));
  EXPECT_THAT(message("<spectrum name='intensity' value='400:1, 300:2'/>"),
              HasSubstr("must ascend; 300 follows 400"));
  EXPECT_THAT(message("<spectrum name='intensity' value='400:1'/>"), HasSubstr("at least two wavelengths"));
  EXPECT_THAT(message("<spectrum name='intensity' value='400:1, 5'/>"), HasSubstr("wavelength:value"));
  EXPECT_THAT(message("<spectrum name='intensity' value='400:1, 500:-1'/>"), HasSubstr("value -1 at 500 nm"));
  EXPECT_THAT(message("<spectrum name='intensity' filename='x.spd'/>"), HasSubstr("no file 'x.spd'"));
  EXPECT_THAT(message("<spectrum name='intensity' type='magic'/>"),
              HasSubstr("spectrum type 'magic' is not one"));
  EXPECT_THAT(message("<string name='intensity' value='red'/>"),
              HasSubstr("must be a colour, such as <rgb>, not a <string>"));
}

TEST_F(MitsubaXml, PointsAndVectors) {
  const auto at = [&](std::string_view element) { return only<PointLight>(good(light(element))).position; };
  EXPECT_EQ(at("<point name='position' x='1' y='2' z='3'/>"), glm::dvec3(1, 2, 3));
  EXPECT_EQ(at("<vector name='position' value='1, 2, 3'/>"), glm::dvec3(1, 2, 3));
  EXPECT_THAT(error(scene(light("<point name='position' x='1' y='2'/>"))),
              HasSubstr("needs the attribute 'z'"));
  EXPECT_THAT(error(scene(light("<point name='position' value='1 2'/>"))),
              HasSubstr("three numbers are wanted, not 2"));
}

TEST_F(MitsubaXml, OddButLegalText) {
  const auto result = read(
      "\xEF\xBB\xBF<?xml version='1.0' encoding='utf-8'?>\r\n<!-- a -- comment -->\r\n"
      "<scene\r\n\tversion = \"3.0.0\" >\r\n<sensor type='perspective'><!-- x --></sensor>\r\n"
      "<?pi?><bsdf type='diffuse' id='k&#228;se &lt;1&gt;'/></scene>");
  EXPECT_TRUE(result) << result.error().message;
}

TEST_F(MitsubaXml, StructureErrors) {
  EXPECT_THAT(error(scene("<shpae type='sphere'/>")),
              HasSubstr("<shpae> is not an element of a scene file; did you mean 'shape'?"));
  EXPECT_THAT(error(scene("<shape tpye='sphere'/>")),
              HasSubstr("<shape> has no attribute 'tpye'; did you mean 'type'?"));
  EXPECT_THAT(error(scene("<shape/>")), HasSubstr("<shape> needs the attribute 'type'"));
  EXPECT_THAT(error(scene("<shape type='sphere'><default name='x' value='1'/></shape>")),
              HasSubstr("<default> belongs directly into <scene>, not into <shape>"));
  EXPECT_THAT(error(scene("<shape type='sphere' type='cube'/>")),
              HasSubstr("the attribute 'type' is there twice"));
  EXPECT_THAT(error(scene("<shape type='sphere'>words</shape>")), HasSubstr("text between elements"));
  EXPECT_THAT(
      error(scene(
          "<shape type='sphere'><float name='radius' value='1'/><float name='radius' value='2'/></shape>")),
      HasSubstr("the parameter 'radius' is there twice"));
  EXPECT_THAT(error(scene("<shape type='sphere'><float value='1'/></shape>")),
              HasSubstr("<float> needs the attribute 'name'"));
  EXPECT_THAT(error(scene("<float name='x' value='1'/>")), HasSubstr("the scene has no parameter 'x'"));
  EXPECT_THAT(error("<scenery version='3.0.0'/>"), HasSubstr("root element <scene>, not <scenery>"));
}

TEST_F(MitsubaXml, NotWellFormed) {
  EXPECT_THAT(error("<scene version='3.0.0'>\n<shape type='sphere'>\n</scene>"),
              AllOf(HasSubstr("scene.xml:3:"), HasSubstr("not well-formed XML"), HasSubstr("</scene>")));
  EXPECT_THAT(error("<scene version='3.0.0'"), HasSubstr("not well-formed"));
  EXPECT_THAT(error("<"), HasSubstr("not well-formed"));
  EXPECT_THAT(error(""), HasSubstr("scene.xml:1:1: error: "));
  EXPECT_THAT(error(std::string("<scene version='3.0.0'>\0</scene>", 32)),
              HasSubstr("not UTF-8 text from here on"));
}

TEST_F(MitsubaXml, OnlyUtf8) {
  const auto with_id = [&](const std::string& id) { return scene("<bsdf type='diffuse' id='" + id + "'/>"); };
  for (const char* id : {"a\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x98\x80"})
    EXPECT_TRUE(read(with_id(id))) << id;
  for (const char* id :
       {"k\xE4se", "\xC0\xAF", "\xED\xA0\x80", "\xF5\x80\x80\x80", "\xE2\x82", "\x80", "\xF0\x80\x80\x80"}) {
    EXPECT_THAT(error(with_id(id)), HasSubstr("scene.xml:2:")) << id;
    EXPECT_THAT(error(with_id(id)), HasSubstr("not UTF-8 text from here on")) << id;
  }
}

TEST_F(MitsubaXml, EntitiesAreRefused) {
  EXPECT_THAT(error("<?xml version='1.0'?>\n<!DOCTYPE scene [<!ENTITY a 'ha'><!ENTITY b '&a;&a;&a;'>]>\n"
                    "<scene version='3.0.0'><shape type='&b;'/></scene>"),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("entities can expand without bound")));
  EXPECT_TRUE(read("<!DOCTYPE scene>\n" + scene("")));
  EXPECT_THAT(error(scene("<shape type='&b;'/>")), HasSubstr("shape type '&b;'"));
}

TEST_F(MitsubaXml, NestingTooDeep) {
  std::string text = "<scene version='3.0.0'>";
  for (int i = 0; i < 100000; ++i) text += "<bsdf type='twosided'>";
  for (int i = 0; i < 100000; ++i) text += "</bsdf>";
  EXPECT_THAT(error(text + "</scene>"), HasSubstr("nested more than 64 deep"));
}

TEST_F(MitsubaXml, SeveralErrorsAtOnce) {
  EXPECT_THAT(error(scene("<shape type='sphear'/><shape type='cub'/>")),
              AllOf(HasSubstr("did you mean 'sphere'?"), HasSubstr("did you mean 'cube'?")));
  std::string many;
  for (int i = 0; i < 40; ++i) many += "<shape type='x" + std::to_string(i) + "'/>\n";
  EXPECT_THAT(error(scene(many)),
              AllOf(HasSubstr("'x19'"), Not(HasSubstr("'x20'")), HasSubstr("and perhaps more")));
}

}  // namespace
}  // namespace penumbra
