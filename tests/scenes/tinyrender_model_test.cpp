// [input] of TinyRender scenes: OBJ and MTL files as shapes and materials.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenes/tinyrender_text.h"
#include "tests/support/tga_file.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

class TinyRenderModel : public TinyRenderText {
 protected:
  SceneDescription model(std::string_view obj, std::string_view mtl = kMaterials) {
    use(obj, mtl);
    return good_toml(scene_with(kDirect));
  }

  std::string model_error(std::string_view obj, std::string_view mtl = kMaterials,
                          const ReadOptions& options = {}) {
    use(obj, mtl);
    return toml_error(scene_with(kDirect), options);
  }

  /// The BSDF of a triangle of the material that `mtl` says.
  SceneDescription material(const std::string& mtl) {
    return model(std::string(kTriangle), "newmtl white\n" + mtl + "\n");
  }

  static const Mesh& mesh(const SceneDescription& scene, std::size_t i = 0) {
    return std::get<Mesh>(scene.shapes.at(i).geometry);
  }

  static glm::dvec3 face_normal(const Mesh& mesh, std::size_t i = 0) {
    const glm::uvec3 t = mesh.triangles.at(i);
    const glm::dvec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    return glm::normalize(glm::cross(b - a, c - a));
  }

  static constexpr const char* kTriangle = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl white\nf 1 2 3\n";
};

TEST_F(TinyRenderModel, ShapesAreObjectsAndTheirMaterials) {
  const SceneDescription scene = model(
      "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\no box\nusemtl white\nf 1 2 3\nusemtl shiny\nf 1 2 "
      "4\n"
      "usemtl white\nf 2 3 4\no other\nf 1 3 4\ng third thing # of them\nusemtl area_light\nf 1 2 3\n");
  ASSERT_THAT(scene.shapes, SizeIs(4));
  EXPECT_EQ(scene.shapes[0].name, "box (white)");
  EXPECT_EQ(scene.shapes[1].name, "box (shiny)");
  EXPECT_EQ(scene.shapes[2].name, "other (white)");
  EXPECT_EQ(scene.shapes[3].name, "third thing (area_light)");
  EXPECT_THAT(mesh(scene, 0).triangles, SizeIs(2));
  EXPECT_THAT(mesh(scene, 0).positions, SizeIs(4));
  EXPECT_THAT(mesh(scene, 1).positions, SizeIs(3)) << "only its own";
  EXPECT_EQ(scene.shapes[0].front_bsdf, scene.shapes[2].front_bsdf) << "one material, one BSDF";
  EXPECT_NE(scene.shapes[0].front_bsdf, scene.shapes[1].front_bsdf);
  EXPECT_THAT(scene.bsdfs, SizeIs(2));
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST_F(TinyRenderModel, DiffuseAndPhongOnBothSides) {
  const SceneDescription diffuse = material("Kd .5 .6 .7\nKs 0 0 0\nNs 10\nKa 1 1 1\nNi 1.5\nd .5\nillum 7");
  ASSERT_THAT(diffuse.bsdfs, SizeIs(1));
  EXPECT_EQ(std::get<DiffuseBsdf>(diffuse.bsdfs[0].model).reflectance, glm::vec3(.5f, .6f, .7f));
  EXPECT_EQ(diffuse.bsdfs[0].name, "white");
  EXPECT_EQ(diffuse.shapes[0].front_bsdf, 0);
  EXPECT_EQ(diffuse.shapes[0].back_bsdf, 0);
  EXPECT_FALSE(diffuse.shapes[0].radiance);
  EXPECT_THAT(diffuse.warnings, IsEmpty());
  const SceneDescription phong = material("Ns 10000\r\nKd 0.1 0.2 .3\r\nKs .4 .5 .7\r\nillum 2\r");
  const auto& model = std::get<PhongBsdf>(phong.bsdfs.at(0).model);
  EXPECT_EQ(model.diffuse, glm::vec3(.1f, .2f, .3f));
  EXPECT_EQ(model.specular, glm::vec3(.4f, .5f, .7f));
  EXPECT_EQ(model.exponent, 10000.0f);
  const SceneDescription mirror = material("Ks 1 1 1\nNs 0");
  EXPECT_EQ(std::get<PhongBsdf>(mirror.bsdfs.at(0).model).diffuse, glm::vec3(0));
  EXPECT_EQ(std::get<DiffuseBsdf>(material("Kd .25").bsdfs.at(0).model).reflectance, glm::vec3(.25f));
}

TEST_F(TinyRenderModel, NamesOfMaterialsHaveALength) {
  EXPECT_THAT(
      model_error(kTriangle, "newmtl " + std::string(1025, 'n') + "\n"),
      HasSubstr("m.mtl:1:8: error: this name of a material has 1025 bytes; the most that are read are"));
}

TEST_F(TinyRenderModel, IllumSevenIsDiffuseWhateverKsSays) {
  for (const std::string rest : {"", "\nNs 10"}) {
    const SceneDescription scene = material("Kd .5 .6 .7\nKs .9 .9 .9" + rest + "\nillum 7");
    EXPECT_EQ(std::get<DiffuseBsdf>(scene.bsdfs.at(0).model).reflectance, glm::vec3(.5f, .6f, .7f));
    EXPECT_THAT(scene.warnings, IsEmpty()) << "Ks counts neither as light given off nor as missing its Ns";
  }
  EXPECT_EQ(material("Ks .9 .9 .9\nNs 10\nillum 7").shapes.at(0).front_bsdf, kBlackBsdf);
  EXPECT_THAT(model_error(kTriangle, "newmtl white\nillum glossy\n"),
              HasSubstr("m.mtl:2:7: error: 'illum' takes the number of a reflection model: 'glossy' is not"));
}

TEST_F(TinyRenderModel, LightsAreBlackUnlessTheyReflect) {
  const SceneDescription light = material("Ke 12 800 0.5");
  EXPECT_THAT(light.bsdfs, IsEmpty());
  EXPECT_EQ(light.shapes.at(0).front_bsdf, kBlackBsdf);
  EXPECT_EQ(light.shapes[0].back_bsdf, kBlackBsdf);
  EXPECT_EQ(light.shapes[0].radiance, glm::vec3(12, 800, .5f));
  EXPECT_FALSE(light.shapes[0].two_sided_emission);
  const SceneDescription both = material("Ke 1 0 0\nKd .5 .5 .5");
  EXPECT_EQ(both.shapes.at(0).front_bsdf, 0);
  EXPECT_EQ(both.shapes[0].radiance, glm::vec3(1, 0, 0));
  EXPECT_FALSE(material("Ke 0 0 0\nKd .5 .5 .5").shapes.at(0).radiance);
  EXPECT_EQ(material("Ka 1 1 1").shapes.at(0).front_bsdf, kBlackBsdf) << "it reflects nothing";
}

TEST_F(TinyRenderModel, MoreThanAllLightIsScaled) {
  // 0.99 of the light in the brightest channel is left: factors of 0.99 / 1.5 and 0.99 / 1.25.
  const SceneDescription phong = material("Kd .5 .5 1\nKs .5 .25 .5\nNs 10");
  const auto& model = std::get<PhongBsdf>(phong.bsdfs.at(0).model);
  EXPECT_FLOAT_EQ(model.diffuse.value.z, 0.66f);
  EXPECT_FLOAT_EQ(model.specular.value.y, 0.165f);
  EXPECT_EQ(warnings(phong),
            "m.mtl:1:8: warning: 'white' would reflect 1.5 of the light it receives; Kd and Ks "
            "are scaled by 0.66, as TinyRender does\n");
  const SceneDescription diffuse = material("Kd 1.25 0 0");
  EXPECT_FLOAT_EQ(std::get<DiffuseBsdf>(diffuse.bsdfs.at(0).model).reflectance.value.x, 0.99f);
  EXPECT_THAT(diffuse.warnings, SizeIs(1));
  EXPECT_THAT(material("Kd .5 .5 .5\nKs .5 .5 .5\nNs 5").warnings, IsEmpty()) << "all of it is not more";
}

TEST_F(TinyRenderModel, ImagesMultiplyWhatMaterialsSay) {
  const std::uint8_t grey[] = {10, 20, 30, 40};
  write("a map.tga", tga_file(2, 2, 1, grey));
  write("b.tga", tga_file(1, 4, 1, grey));
  const SceneDescription plain = material("map_Kd -s 2 3 1 -o .5 .25 -clamp on a map.tga");
  const auto& diffuse = std::get<DiffuseBsdf>(plain.bsdfs.at(0).model);
  ASSERT_EQ(diffuse.reflectance.texture, 0) << "white where there is no Kd";
  const SceneTexture& texture = plain.textures.at(0);
  const auto& bitmap = std::get<BitmapTexture>(texture.model);
  EXPECT_EQ(bitmap.wrap_u, WRAP_CLAMP);
  EXPECT_EQ(bitmap.gamma, kSrgb);
  EXPECT_EQ(plain.bitmaps.at(0)->width, 2);
  EXPECT_EQ(texture.to_uv * glm::dvec3(0, 0, 1), glm::dvec3(0.5, 0.75, 1)) << "v counts from the bottom";
  EXPECT_EQ(texture.to_uv * glm::dvec3(1, 1, 1), glm::dvec3(2.5, -2.25, 1));
  EXPECT_THAT(warnings(plain), HasSubstr("no texture coordinates"));
  const SceneDescription phong =
      material("Kd .5 .25 .5\nKs .25 .25 .25\nNs 20\nmap_Kd a map.tga\nmap_Ks b.tga\nmap_Ns b.tga");
  const auto& glossy = std::get<PhongBsdf>(phong.bsdfs.at(0).model);
  EXPECT_THAT(phong.bitmaps, SizeIs(2)) << "one file, one bitmap";
  const auto scale_of = [&](int index) {
    return std::get<ScaleTexture>(phong.textures.at(std::size_t(index)).model);
  };
  EXPECT_EQ(scale_of(glossy.diffuse.texture).scale.value, glm::vec3(.5f, .25f, .5f));
  EXPECT_EQ(scale_of(glossy.specular.texture).scale.value, glm::vec3(.25f));
  EXPECT_EQ(scale_of(glossy.exponent.texture).scale.value, glm::vec3(20));
  const int numbers = scale_of(glossy.exponent.texture).texture;
  EXPECT_EQ(std::get<BitmapTexture>(phong.textures.at(std::size_t(numbers)).model).gamma, 1.0f);
  EXPECT_EQ(
      warnings(material("map_Kd -bm 1 -mm 0 1 b.tga")).find("m.mtl:2:12: warning: map_Kd: the option -bm"),
      0u);
}

TEST_F(TinyRenderModel, ImagesThatAreNotThereAreErrors) {
  const auto wrong = [&](const std::string& line) {
    return model_error(std::string(kTriangle), "newmtl white\n" + line + "\n");
  };
  EXPECT_THAT(wrong("map_Kd none.png"), HasSubstr("m.mtl:2:8: error: there is no file 'none.png'"));
  EXPECT_THAT(wrong("map_Kd -q 1 a.png"), HasSubstr("'-q' is not an option of map_Kd"));
  EXPECT_THAT(wrong("map_Kd -s x a.png"), HasSubstr("'-s' takes one to three numbers"));
  EXPECT_THAT(wrong("map_Kd"), HasSubstr("map_Kd needs the name of an image"));
  use(std::string(kTriangle), "newmtl white\nmap_Kd none.png\n");
  const auto lenient = read_toml(scene_with(kDirect), {.lenient = true});
  ASSERT_TRUE(lenient) << lenient.error().message;
  EXPECT_EQ(std::get<CheckerboardTexture>(lenient->textures.at(0).model).color0, glm::vec3(0.8f, 0.2f, 0.8f));
}

TEST_F(TinyRenderModel, MaterialsWithWarnings) {
  EXPECT_EQ(warnings(material("Kd .5 .5 .5\nmap_d wood.png\nbump -bm 1 b.png\nKX 1\nillu 2")),
            "m.mtl:3:1: warning: map_d: this texture is not read; what is plain counts\n"
            "m.mtl:4:1: warning: bump: this texture is not read; what is plain counts\n"
            "m.mtl:5:1: warning: 'KX' is not an MTL statement; did you mean 'Kd'?; it is left out\n"
            "m.mtl:6:1: warning: 'illu' is not an MTL statement; did you mean 'illum'?; it is left out\n");
  const SceneDescription no_exponent = material("Kd .5 .5 .5\nKs .1 .1 .1");
  EXPECT_EQ(warnings(no_exponent), "m.mtl:1:8: warning: 'white' has Ks but no Ns; Ks is left out\n");
  EXPECT_TRUE(std::holds_alternative<DiffuseBsdf>(no_exponent.bsdfs.at(0).model));
  const SceneDescription twice = material("Kd .5 .5 .5\nnewmtl white\nKd .1 .1 .1\nKe 1 1 1");
  EXPECT_THAT(warnings(twice), HasSubstr("m.mtl:3:8: warning: the material 'white' is there already, at "));
  EXPECT_EQ(std::get<DiffuseBsdf>(twice.bsdfs.at(0).model).reflectance.value.x, 0.5f);
  EXPECT_FALSE(twice.shapes.at(0).radiance);
}

TEST_F(TinyRenderModel, MaterialsWithErrors) {
  const auto error = [&](const std::string& mtl) {
    return model_error(kTriangle, "newmtl white\n" + mtl + "\n");
  };
  EXPECT_EQ(error("Kd .5 .6"), "m.mtl:2:9: error: 'Kd' takes 3 numbers, not 2\n  Kd .5 .6\n          ^");
  EXPECT_THAT(error("Kd"), HasSubstr("m.mtl:2:3: error: 'Kd' takes 3 numbers, not 0"));
  EXPECT_THAT(error("Kd .5 .6 .7 .8"), HasSubstr("m.mtl:2:13: error: 'Kd' takes 3 numbers, not more"));
  EXPECT_THAT(error("Kd .5 nan .5"), HasSubstr("m.mtl:2:7: error: 'nan' is not a finite number"));
  EXPECT_THAT(error("Ke 1 -1 1"), HasSubstr("m.mtl:2:6: error: 'Ke' must be 0 or more and finite, not -1"));
  EXPECT_THAT(error("Ke 1e39 1 1"), HasSubstr("'Ke' must be 0 or more and finite"));
  EXPECT_THAT(error("Ns -3"), HasSubstr("m.mtl:2:4: error: 'Ns' must be 0 or more and finite, not -3"));
  EXPECT_THAT(error("Ns 3 4"), HasSubstr("m.mtl:2:6: error: 'Ns' takes 1 number, not more"));
  EXPECT_THAT(error("Ns ten"), HasSubstr("'ten' is not a number"));
  EXPECT_THAT(error("Kd spectral file.rfl"), HasSubstr("m.mtl:2:4: error: 'spectral' is not a number"));
  EXPECT_THAT(error("newmtl"), HasSubstr("m.mtl:2:7: error: newmtl needs a name"));
  EXPECT_THAT(model_error(kTriangle, "Kd 1 1 1\nnewmtl white\n"),
              HasSubstr("m.mtl:1:1: error: Kd before any newmtl"));
  const std::string both = error("Kd x 0 0\nKe 0 y 0");
  EXPECT_THAT(both, AllOf(HasSubstr("'x' is not a number"), HasSubstr("'y' is not a number")));
}

TEST_F(TinyRenderModel, MissingMaterials) {
  const std::string undefined = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl whit\nf 1 2 3\n";
  EXPECT_EQ(model_error(undefined),
            "m.obj:5:8: error: the material 'whit' is not defined; did you mean 'white'? The "
            "MTL files define: area_light, shiny, white\n  usemtl whit\n         ^");
  EXPECT_THAT(model_error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("m.obj:4:1: error: this face has no material: there is no usemtl before it"));
  const std::string no_file = "mtllib n.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl white\nf 1 2 3\n";
  EXPECT_THAT(model_error(no_file),
              AllOf(HasSubstr("m.obj:1:8: error: there is no file 'n.mtl'; looked in: "),
                    Not(HasSubstr("is not defined"))));
  EXPECT_THAT(model_error("mtllib\n"), HasSubstr("m.obj:1:7: error: the file name is empty"));
  use(undefined);
  const SceneDescription lenient = good_toml(scene_with(kDirect), {.lenient = true});
  EXPECT_THAT(warnings(lenient), HasSubstr("m.obj:5:8: warning: the material 'whit' is not defined"));
  EXPECT_EQ(std::get<DiffuseBsdf>(lenient.bsdfs.at(0).model).reflectance, glm::vec3(.8f, .2f, .8f));
}

TEST_F(TinyRenderModel, FileNames) {
  write("two words.mtl", "newmtl white\nKd .1 .1 .1\n");
  write("other.mtl", "newmtl blue # not red\nKd 0 0 .9\n");
  const SceneDescription scene = model(
      "mtllib two words.mtl\nmtllib m.mtl other.mtl\nmtllib other.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
      "usemtl white\nf 1 2 3\nusemtl blue\nf 1 2 3\n",
      "newmtl red\n");
  EXPECT_THAT(scene.warnings, IsEmpty());
  EXPECT_EQ(std::get<DiffuseBsdf>(scene.bsdfs.at(0).model).reflectance.value.x, 0.1f);
  EXPECT_EQ(std::get<DiffuseBsdf>(scene.bsdfs.at(1).model).reflectance.value.z, 0.9f);
  // The OBJ file is looked for beside the TOML file, and the MTL file beside the OBJ file.
  std::filesystem::create_directory(folder_ / "deep");
  write("deep/deep.obj", "mtllib deep.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  write("deep/deep.mtl", "newmtl a\nKe 1 1 1\n");
  std::string text = scene_with(kDirect);
  text.replace(text.find("m.obj"), 5, "deep/deep.obj");
  EXPECT_TRUE(good_toml(text).shapes.at(0).radiance);
  text.replace(text.find("deep/deep.obj"), 13, "none.obj");
  EXPECT_THAT(toml_error(text),
              HasSubstr("scene.toml:2:11: error: there is no file 'none.obj'; looked in: "));
}

TEST_F(TinyRenderModel, BadObjStatementsAndIndices) {
  EXPECT_THAT(model_error("mtllib m.mtl\nv 0 0 0\nusemtl area_light\nf 1 2 3\n"),
              AllOf(HasSubstr("m.obj:4:5: error: vertex index 2 is out of range"),
                    HasSubstr("(which is named at "), HasSubstr("scene.toml:2:11)")));
  EXPECT_THAT(model_error("v 0 0 inf\n"), HasSubstr("m.obj:1:7: error: 'inf' is not a finite number"));
  EXPECT_THAT(model_error("mtllib m.mtl\nv 0 0 0\nv 1e38 0 0\nv 0 1 0\nusemtl white\nf 1 2 3\n"),
              HasSubstr("m.obj:6:1: error: 'white': vertex 2 is too far away"));
}

TEST_F(TinyRenderModel, VertexNormals) {
  // Written with four decimals, which are not the face's exactly; the light of grid.obj.
  const std::string light =
      "mtllib m.mtl\nv -2.657980 2.939692 1.0\nv -3.342020 1.060307 1.0\n"
      "v -2.657980 2.939692 -1.0\nvn 0.9397 -0.3420 0.0000\nusemtl area_light\n";
  const SceneDescription faceted = model(light + "f 2//1 3//1 1//1\n");
  EXPECT_THAT(mesh(faceted).normals, IsEmpty());
  EXPECT_GT(face_normal(mesh(faceted)).x, 0.9);
  // Wound against its normals: these say where the front is.
  const SceneDescription turned = model(light + "f 1//1 3//1 2//1\n");
  EXPECT_THAT(mesh(turned).normals, IsEmpty());
  EXPECT_GT(face_normal(mesh(turned)).x, 0.9);
  // Without normals the corners say it, and nothing is smoothed across the fold.
  const std::string fold = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nusemtl white\n";
  const SceneDescription plain = model(fold + "f 1 2 3\nf 1 4 2\n");
  EXPECT_THAT(mesh(plain).normals, IsEmpty());
  EXPECT_GT(face_normal(mesh(plain), 0).z, 0.9);
  EXPECT_GT(face_normal(mesh(plain), 1).y, 0.9);
  // Others are interpolated.
  const SceneDescription smooth = model(fold + "vn 0 1 1\nvn 0 0 2\nf 1//1 2//1 3//2\n");
  ASSERT_THAT(mesh(smooth).normals, SizeIs(3));
  EXPECT_NEAR(mesh(smooth).normals[0].y, std::sqrt(0.5), 1e-6);
  EXPECT_EQ(mesh(smooth).normals[2], glm::vec3(0, 0, 1));
  const SceneDescription short_normal = model(fold + "vn 0 0 0\nf 1//1 2//1 3//1\n");
  EXPECT_EQ(warnings(short_normal),
            "m.obj:8:1: warning: 'white': 3 normals are missing or of no length; computed from the "
            "faces\n");
}

TEST_F(TinyRenderModel, ConcaveFacesAreCutInside) {
  // An arrow: a fan about its first corner would cover the notch.
  const SceneDescription scene =
      model("mtllib m.mtl\nv 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nusemtl area_light\nf 1 2 3 4\n");
  const Mesh& arrow = mesh(scene);
  ASSERT_THAT(arrow.triangles, SizeIs(2));
  double area = 0.0;
  for (const glm::uvec3& t : arrow.triangles) {
    const glm::dvec3 n =
        glm::cross(arrow.positions[t.y] - arrow.positions[t.x], arrow.positions[t.z] - arrow.positions[t.x]);
    EXPECT_GT(n.z, 0.0);
    area += 0.5 * n.z;
  }
  EXPECT_DOUBLE_EQ(area, 1.0);
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST_F(TinyRenderModel, OddFacesOfSurfacesAreRepairedAndCounted) {
  const std::string head =
      "mtllib m.mtl\nv 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv 1 0 .2\nv 3 3 3\nv 6 6 6\n"
      "usemtl white\n";
  const SceneDescription bow = model(head + "f 1 2 3 4\nf 1 2 3\nf 1 2 3 4\n");
  EXPECT_EQ(warnings(bow),
            "m.obj:10:1: warning: 'white': 2 faces fold over or back on themselves; cut into fans of "
            "triangles that overlap\n");
  EXPECT_THAT(mesh(bow).triangles, SizeIs(5));
  const SceneDescription warped = model(head + "f 1 3 2 4\nf 1 5 2 4\n");
  EXPECT_THAT(warnings(warped),
              AllOf(HasSubstr("m.obj:11:1: warning: 'white': 1 face is not flat (by up to 0.0"),
                    HasSubstr("of its extent); cut into flat triangles")));
  EXPECT_THAT(mesh(warped).triangles, SizeIs(4));
  const SceneDescription flat = model(head + "f 1 6 7\nf 1 3 2\nf 1 1 2\n");
  EXPECT_EQ(warnings(flat), "m.obj:10:1: warning: 'white': left out 2 triangles without area\n");
  EXPECT_THAT(mesh(flat).triangles, SizeIs(1));
  const SceneDescription nothing = model(head + "f 1 6 7\n");
  EXPECT_THAT(nothing.shapes, IsEmpty());
  EXPECT_THAT(warnings(nothing),
              HasSubstr("m.obj:10:1: warning: 'white' has no triangles; it is left out\n"));
  // Six decimals of a face of a thousandth are flat enough.
  EXPECT_THAT(
      model("mtllib m.mtl\nv 0 0 0\nv .001 0 0\nv .001 .001 .000001\nv 0 .001 0\nusemtl white\nf 1 2 3 4\n")
          .warnings,
      IsEmpty());
}

TEST_F(TinyRenderModel, OddFacesOfLights) {
  const std::string head =
      "mtllib m.mtl\nv 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv 1 0 .2\nv 3 3 3\nv 6 6 6\n"
      "o sign\nusemtl area_light\n";
  for (const bool lenient : {false, true}) {
    EXPECT_THAT(
        model_error(head + "f 1 2 3\nf 1 2 3 4\n", kMaterials, {.lenient = lenient}),
        HasSubstr(
            "m.obj:12:1: error: 'sign (area_light)': this face of a light crosses itself or folds back on "
            "itself, so that its light is not defined\n  f 1 2 3 4\n  ^"));
  }
  EXPECT_THAT(warnings(model(head + "f 1 5 2 4\n")), HasSubstr("'sign (area_light)': 1 face is not flat"));
  const SceneDescription gone = model(head + "f 1 6 7\n");
  EXPECT_THAT(gone.shapes, IsEmpty());
  EXPECT_THAT(warnings(gone),
              HasSubstr("'sign (area_light)' has no triangles; it is left out, and its light with it"));
}

}  // namespace
}  // namespace penumbra
