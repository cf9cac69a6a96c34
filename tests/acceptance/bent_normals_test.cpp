// Normal maps and bump maps against surfaces with equivalent vertex normals; turned tangents against turned
// texture coordinates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

using glm::dvec3;

/// A square of side 2 in the plane z = 0 that faces +z, u along x and v along y, under a light on one side.
/// Bent as real normals are, which cast no shadows on each other.
SceneDescription square(SurfaceBend bend, glm::vec3 normal = {0, 0, 1}, bool behind = false) {
  SceneDescription scene = empty_scene(4, 4, 64, 5);
  bend.shadows = false;
  scene.camera = look_at(dvec3(0.2, 0.1, behind ? -4 : 4), dvec3(0), dvec3(0, 1, 0), 20);
  scene.bsdfs.push_back({"white", DiffuseBsdf{glm::vec3(0.8f)}, bend});
  Shape wall = parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0);
  auto& mesh = std::get<Mesh>(wall.geometry);
  mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  if (normal != glm::vec3(0, 0, 1)) mesh.normals.assign(6, glm::normalize(normal));
  wall.back_bsdf = 0;
  scene.shapes.push_back(wall);
  scene.shapes.push_back(parallelogram({2, -1, behind ? -3 : 1}, {0, 2, 0}, {0, 0, 2}, kBlackBsdf, 5.0f));
  scene.shapes.back().two_sided_emission = true;
  scene.integrator = path_integrator(DirectSampling::kMis);
  return scene;
}

/// A texture of one value.
void set_texture(SceneDescription& scene, glm::vec3 value) {
  CheckerboardTexture plain;
  plain.color0 = plain.color1 = value;
  scene.textures = {{"plain", plain}};
}

void expect_same(const SceneDescription& a, const SceneDescription& b, double tolerance = 1e-5) {
  const FilmAccumulator film_a = render_or_throw(a), film_b = render_or_throw(b);
  double sum = 0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      EXPECT_NEAR(film_a.at(x, y).mean[1], film_b.at(x, y).mean[1], tolerance) << x << ' ' << y;
      for (const int c : {0, 1, 2})
        EXPECT_NEAR(film_a.layer(x, y, LAYER_NORMAL, c), film_b.layer(x, y, LAYER_NORMAL, c), 1e-5)
            << x << ' ' << y;
      sum += film_b.at(x, y).mean[1];
    }
  EXPECT_GT(sum / 16, 100 * tolerance) << "there is something to compare";
}

TEST(BentNormals, AFlatMapChangesNothing) {
  SceneDescription mapped = square({BendKind::kNormalMap, 0});
  set_texture(mapped, {0.5f, 0.5f, 1});
  expect_same(mapped, square({}));
  SceneDescription bumped = square({BendKind::kBumpMap, 0, 3});
  set_texture(bumped, glm::vec3(0.7f));
  expect_same(bumped, square({}));
}

TEST(BentNormals, AMapOfOneNormalIsASurfaceOfThatNormal) {
  for (const glm::vec3 n : {glm::vec3(0.3f, -0.2f, 0.9f), glm::vec3(-0.5f, 0.4f, 0.7f)}) {
    SceneDescription mapped = square({BendKind::kNormalMap, 0});
    set_texture(mapped, 0.5f * (n + 1.0f));
    expect_same(mapped, square({}, n));
  }
}

TEST(BentNormals, FromBehindTheBumpsAreMirroredOrTheOtherSides) {
  const glm::vec3 n(0.3f, -0.2f, 0.9f);
  SceneDescription mirrored = square({BendKind::kNormalMap, 0}, {0, 0, 1}, true);
  set_texture(mirrored, 0.5f * (n + 1.0f));
  expect_same(mirrored, square({}, {-n.x, -n.y, n.z}, true));  // whose other side is (n.x, n.y, -n.z)
  SceneDescription other = square({BendKind::kNormalMap, 0, -1}, {0, 0, 1}, true);
  set_texture(other, 0.5f * (n + 1.0f));
  expect_same(other, square({}, n, true));
}

TEST(BentNormals, NormalsThatLookAwayLeanTheOtherWay) {
  const glm::vec3 away(0.95f, 0, 0.1f);
  SceneDescription mapped = square({BendKind::kNormalMap, 0});
  mapped.camera = look_at(dvec3(-4, 0.1, 1), dvec3(0), dvec3(0, 0, 1), 1);
  SceneDescription plain = square({}, {-away.x, away.y, away.z});
  plain.camera = mapped.camera;
  set_texture(mapped, 0.5f * (away + 1.0f));
  const FilmAccumulator a = render_or_throw(mapped), b = render_or_throw(plain);
  EXPECT_NEAR(a.layer(2, 2, LAYER_NORMAL), b.layer(2, 2, LAYER_NORMAL), 1e-5);
  EXPECT_NEAR(a.layer(2, 2, LAYER_NORMAL), -0.9945, 1e-3);
  // And light below the surface is discarded.
  set_texture(mapped, {0.7f, 0.5f, 0.2f});
  EXPECT_NEAR(render_or_throw(mapped).layer(2, 2, LAYER_NORMAL, 2), 1, 1e-6);
}

/// The square with a coat over a base of this colour that reflects nothing else, of which these maps bend
/// base and coat.
SceneDescription coated(SurfaceBend base, std::optional<SurfaceBend> coat, float colour = 0,
                        glm::vec3 normal = {0, 0, 1}, bool behind = false) {
  SceneDescription scene = square(base, normal, behind);
  OpenPbrBsdf surface;
  surface.base_color = TexturedColour(glm::vec3(colour));
  surface.specular_weight = 0.0f, surface.coat_weight = 1.0f, surface.coat_roughness = 0.5f;
  scene.bsdfs[0].model = surface;
  scene.bsdfs[0].coat_bend = coat;
  return scene;
}

/// Compares means of images with other samples, within 4 standard errors of independent ones: by chance one
/// of 16 000 is beyond.
void expect_same_light(SceneDescription a, SceneDescription b) {
  double mean[2] = {0, 0}, variance = 0;
  for (const int which : {0, 1}) {
    SceneDescription& scene = which == 0 ? a : b;
    scene.sampler.spp = 2048;
    const FilmAccumulator film = render_or_throw(scene);
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) {
        const PixelStatistics& pixel = film.at(x, y);
        const double count = double(pixel.count);
        mean[which] += pixel.mean[1] / 16;
        variance += pixel.m2[1] / ((count - 1) * count) / 256;
      }
  }
  EXPECT_NEAR(mean[0], mean[1], 4 * std::sqrt(variance));
  EXPECT_LT(std::sqrt(variance), 0.05 * mean[1]) << "too noisy to compare";
}

TEST(CoatNormals, OfTheMapOfTheBaseAreThoseOfTheBase) {
  const SurfaceBend map{BendKind::kNormalMap, 0};
  SceneDescription own = coated(map, map, 0.5f), same = coated(map, std::nullopt, 0.5f);
  own.bsdfs[0].bend.shadows = same.bsdfs[0].bend.shadows = true;
  for (SceneDescription* scene : {&own, &same}) set_texture(*scene, {0.7f, 0.4f, 0.9f});
  for (const IntegratorSettings& integrator :
       {path_integrator(DirectSampling::kMis), direct_integrator(2, 3)}) {
    own.integrator = same.integrator = integrator;
    expect_same(own, same);
  }
}

// Over a black base only the coat reflects, also light from below the base's horizon: the third normal is at
// 70 degrees from the surface's, so that the light or the viewer is nearly there.
TEST(CoatNormals, ASmoothCoatOverABentBlackBaseIsThatOverASmoothOne) {
  for (const glm::vec3 n :
       {glm::vec3(0.3f, -0.2f, 0.9f), glm::vec3(-0.5f, 0.4f, 0.7f), glm::vec3(-0.94f, 0, 0.34f)})
    for (const bool behind : {false, true})
      for (const IntegratorSettings& integrator :
           {path_integrator(DirectSampling::kMis), path_integrator(DirectSampling::kBsdfOnly),
            direct_integrator(2, 3)}) {
        SceneDescription bent = coated({BendKind::kNormalMap, 0}, SurfaceBend{}, 0, {0, 0, 1}, behind);
        SceneDescription smooth = coated({}, std::nullopt, 0, {0, 0, 1}, behind);
        set_texture(bent, 0.5f * (n + 1.0f));
        bent.integrator = smooth.integrator = integrator;
        expect_same_light(bent, smooth);
      }
}

TEST(CoatNormals, ABentCoatOverABlackBaseIsThatOverABentOne) {
  for (const BendKind kind : {BendKind::kNormalMap, BendKind::kBumpMap}) {
    SceneDescription coat = coated({}, SurfaceBend{kind, 0, 1}), all = coated({kind, 0, 1}, std::nullopt);
    for (SceneDescription* scene : {&coat, &all}) {
      set_texture(*scene, {0.65f, 0.4f, 0.9f});
      if (kind == BendKind::kBumpMap) {
        CheckerboardTexture board;
        board.color0 = glm::vec3(0), board.color1 = glm::vec3(0.2f);
        scene->textures[0] = {"board", board, glm::dmat3(3)};
      }
    }
    expect_same_light(coat, all);
  }
}

TEST(CoatNormals, WithoutACoatChangeNothing) {
  SceneDescription bent = coated({BendKind::kNormalMap, 0}, SurfaceBend{}, 0.5f);
  set_texture(bent, {0.7f, 0.4f, 0.9f});
  std::get<OpenPbrBsdf>(bent.bsdfs[0].model).coat_weight = 0.0f;
  EXPECT_EQ(build_or_throw(bent).header.features & FEATURE_COAT_NORMALS, 0u);
  SceneDescription plain = bent;
  plain.bsdfs[0].coat_bend.reset();
  expect_same(bent, plain, 1e-7);
}

/// The square as brushed metal. u grows at `angle` to x.
SceneDescription brushed(const SurfaceTurn& turn, double angle, bool behind = false) {
  SceneDescription scene = square({}, {0, 0, 1}, behind);
  OpenPbrBsdf metal;
  metal.base_metalness = 1.0f, metal.specular_anisotropy = 0.9f;
  scene.bsdfs[0].model = metal;
  scene.bsdfs[0].turn = turn;
  for (glm::vec2& uv : std::get<Mesh>(scene.shapes[0].geometry).texcoords)
    uv = {std::cos(angle) * uv.x + std::sin(angle) * uv.y, std::cos(angle) * uv.y - std::sin(angle) * uv.x};
  return scene;
}

/// The same with the tangent `angle` from that of a texture's direction, which is at `of_texture`.
SceneDescription textured(double angle, double of_texture, bool mirrored) {
  SceneDescription scene = brushed({.texture = 0, .angle = float(angle), .mirrored = mirrored}, 0);
  set_texture(scene, 0.5f + 0.5f * glm::vec3(std::cos(of_texture), std::sin(of_texture), 0.3));
  return scene;
}

TEST(TurnedTangents, AreThoseOfTurnedTextureCoordinates) {
  for (const double angle : {0.7, -2.0}) {
    const SceneDescription expected = brushed({}, angle);
    expect_same(brushed({.angle = float(angle)}, 0), expected);
    expect_same(brushed({.angle = float(-angle), .mirrored = true}, 0), expected);
    expect_same(textured(0.4, angle - 0.4, false), expected);
    expect_same(textured(0.4, -angle - 0.4, true), expected);
    expect_same(brushed({.angle = float(angle)}, 0, true), brushed({}, angle, true));
    const double turned = render_or_throw(expected).at(1, 1).mean[1],
                 straight = render_or_throw(brushed({}, 0)).at(1, 1).mean[1];
    EXPECT_GT(std::abs(std::log(turned / straight)), 0.05) << "what is compared does not depend on the turn";
  }
}

TEST(BentNormals, BumpsAreSlopesOfHeights) {
  // The surface is so small in its coordinates that a step to either side of any point crosses the edge
  // between two squares of the board: the slope is the same everywhere.
  for (const bool along_v : {false, true}) {
    const float scale = 3;
    SceneDescription bumped = square({BendKind::kBumpMap, 0, scale});
    CheckerboardTexture board;
    board.color0 = glm::vec3(0);
    board.color1 = glm::vec3(1);
    SceneTexture texture{"board", board};
    // Coordinates that change by less than a step over the surface, to both sides of an edge.
    const double slow = kBendStep / 4;
    const glm::dmat3 along_u_only(glm::dvec3(1, 0, 0), glm::dvec3(0, slow, 0), glm::dvec3(0, 0.25, 1));
    const glm::dmat3 along_v_only(glm::dvec3(slow, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0.25, 0, 1));
    texture.to_uv = along_v ? along_v_only : along_u_only;
    bumped.textures = {texture};
    Shape& wall = bumped.shapes[0];
    for (glm::vec2& uv : std::get<Mesh>(wall.geometry).texcoords) {
      (along_v ? uv.y : uv.x) = 0.5f + ((along_v ? uv.y : uv.x) - 0.5f) * kBendStep;
    }
    // In these coordinates dp/du is 2 / kBendStep, and heights change by scale / (2 kBendStep).
    const double slope = scale / (2.0 * kBendStep) / (2.0 / kBendStep);
    const glm::vec3 n = along_v ? glm::vec3(0, -slope, 1) : glm::vec3(-slope, 0, 1);
    SceneDescription plain = square({}, n);
    const FilmAccumulator a = render_or_throw(bumped), b = render_or_throw(plain);
    for (const int c : {0, 1, 2})
      EXPECT_NEAR(a.layer(2, 2, LAYER_NORMAL, c), b.layer(2, 2, LAYER_NORMAL, c), 1e-4 * slope) << along_v;
  }
}

}  // namespace
}  // namespace penumbra
