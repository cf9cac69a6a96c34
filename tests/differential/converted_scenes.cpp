#include "tests/differential/converted_scenes.h"

#include <cstring>

namespace penumbra::differential {
namespace {

/// A floor at y = 0, 4 wide, that looks up, and a light above it, 1 wide, that looks down.
constexpr const char* kFloor = "v -2 0 -2\nv -2 0 2\nv 2 0 2\nv 2 0 -2\nf 1 2 3 4\n";
constexpr const char* kAreaLight = "v -.5 2 -.5\nv .5 2 -.5\nv .5 2 .5\nv -.5 2 .5\nf 1 2 3 4\n";

SceneText converted(std::string name, std::string file, std::string text, std::vector<MeshFile> files) {
  SceneText scene;
  scene.name = std::move(name);
  scene.converted = std::move(file);
  scene.ours = std::move(text);
  scene.meshes = std::move(files);
  // Points of Mitsuba's ldsampler are alike from batch to batch, so that errors cannot be told from them: of
  // two lights its images were not the sum of those of each.
  scene.settings = {
      {"film.width", "24"}, {"film.height", "24"}, {"film.rfilter", "box"}, {"sampler.type", "independent"}};
  return scene;
}

SceneText nori() {
  return converted("converted_nori", "scene.xml", R"(<scene>
<integrator type="path_mis"/>
<camera type="perspective">
  <transform name="toWorld"><scale value="-1,1,1"/><lookat origin="0,1.5,5" target="0,.6,0" up="0,1,0"/></transform>
  <float name="fov" value="40"/><integer name="width" value="24"/><integer name="height" value="24"/>
</camera>
<mesh type="obj"><string name="filename" value="floor.obj"/>
  <bsdf type="diffuse"><color name="albedo" value=".6,.5,.3"/></bsdf></mesh>
<mesh type="obj"><string name="filename" value="area_light.obj"/>
  <bsdf type="diffuse"/><emitter type="area"><color name="radiance" value="6,5,4"/></emitter></mesh>
<mesh type="obj"><string name="filename" value="plate.obj"/><bsdf type="mirror"/></mesh>
</scene>
)",
                   {{"floor.obj", kFloor},
                    {"area_light.obj", kAreaLight},
                    {"plate.obj", "v -1 0 -1\nv 1 0 -1\nv 1 1.5 -1.4\nv -1 1.5 -1.4\nf 1 2 3 4\n"}});
}

SceneText pbrt() {
  return converted("converted_pbrt", "scene.pbrt", R"(LookAt 0 1.5 5  0 .6 0  0 1 0
Camera "perspective" "float fov" [40]
Film "rgb" "integer xresolution" [24] "integer yresolution" [24]
Integrator "path" "integer maxdepth" [3]
WorldBegin
LightSource "infinite" "rgb L" [.2 .3 .4]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [6 5 4]
  Shape "trianglemesh" "point3 P" [-.5 2 -.5  .5 2 -.5  .5 2 .5  -.5 2 .5] "integer indices" [0 1 2 0 2 3]
AttributeEnd
Material "diffuse" "rgb reflectance" [.6 .5 .3]
Shape "trianglemesh" "point3 P" [-2 0 -2  -2 0 2  2 0 2  2 0 -2] "integer indices" [0 1 2 0 2 3]
AttributeBegin
  Translate -.7 .5 0
  Material "conductor" "rgb reflectance" [.9 .7 .4] "float roughness" [.1]
  Shape "sphere" "float radius" [.5]
AttributeEnd
AttributeBegin
  Translate .7 .5 0
  Material "dielectric" "float eta" [1.5]
  Shape "sphere" "float radius" [.5]
AttributeEnd
)",
                   {});
}

SceneText tinyrender() {
  return converted(
      "converted_tinyrender", "scene.toml", R"([input]
objfile = "m.obj"
[camera]
eye = [0, 1.5, 5]
at = [0, 0.6, 0]
fov = 40
[film]
width = 24
height = 24
[renderer]
type = "path"
isExplicit = true
maxDepth = 3
rrDepth = 5
rrProb = 0.95
)",
      {{"m.obj",
        "mtllib m.mtl\no floor\nv -2 0 -2\nv -2 0 2\nv 2 0 2\nv 2 0 -2\nusemtl white\nf 1 2 3 4\n"
        "o area_light\nv -.5 2 -.5\nv .5 2 -.5\nv .5 2 .5\nusemtl area_light\nf 5 6 7\n"
        "o wall\nv -1 0 -1\nv 1 0 -1\nv 1 1.5 -1.4\nv -1 1.5 -1.4\nusemtl red\nf 8 9 10 11\n"},
       {"m.mtl", "newmtl white\nKd .5 .6 .7\nnewmtl red\nKd .7 .2 .1\nnewmtl area_light\nKe 9 8 7\n"}});
}

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? std::uint32_t(std::uint8_t(bytes[i + k])) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63u];
  }
  return text;
}

/// A square [-1, 1]² that faces z, three times: a floor of metal, a wall, a light; and a point light.
SceneText gltf() {
  const float corners[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, -1, 0, 1, 1, 0, -1, 1, 0};
  std::string bytes(sizeof corners, '\0');
  std::memcpy(bytes.data(), corners, sizeof corners);
  const std::string text =
      R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3, 4]}],
"extensionsUsed": ["KHR_lights_punctual"],
"extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 2000, "color": [1, 0.8, 0.6]}]}},
"nodes": [
  {"camera": 0, "translation": [0, 1.2, 5]},
  {"mesh": 0, "rotation": [-0.70710678, 0, 0, 0.70710678], "scale": [2, 2, 2]},
  {"mesh": 1, "translation": [0, 1, -1.2]},
  {"mesh": 2, "rotation": [0.70710678, 0, 0, 0.70710678], "translation": [0, 2.5, 0], "scale": [0.5, 0.5, 0.5]},
  {"translation": [1, 1.5, 1.5], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
"cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": 1, "znear": 0.01}}],
"meshes": [
  {"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]},
  {"primitives": [{"attributes": {"POSITION": 0}, "material": 1}]},
  {"primitives": [{"attributes": {"POSITION": 0}, "material": 2}]}],
"materials": [
  {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.7, 0.5, 1], "metallicFactor": 1, "roughnessFactor": 0.5}},
  {"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.5, 0.6, 1], "metallicFactor": 0, "roughnessFactor": 0.6}},
  {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}, "emissiveFactor": [1, 0.9, 0.8]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]}],
"bufferViews": [{"buffer": 0, "byteLength": 72}],
"buffers": [{"byteLength": 72, "uri": "data:application/octet-stream;base64,)" +
      base64(bytes) + "\"}]}\n";
  SceneText scene = converted("converted_gltf", "scene.gltf", text, {});
  scene.settings.emplace_back("integrator.max_depth", "4");
  return scene;
}

/// Four by four texels, whole numbers of 8 bit.
std::string picture() {
  std::string text = "P6\n4 4\n255\n";
  for (int i = 0; i < 16; ++i)
    for (const int channel : {40 + 14 * i, 250 - 12 * i, 60 + (i % 4) * 60}) text += char(channel);
  return text;
}

constexpr const char* kView =
    "<sensor type='perspective'><float name='fov' value='40'/><transform name='toWorld'><lookat origin='0, "
    "1.5, 5' "
    "target='0, .6, 0' up='0, 1, 0'/></transform></sensor>\n<integrator type='path'><integer name='maxDepth' "
    "value='4'/></integrator>\n<shape type='rectangle'><transform name='toWorld'><scale value='2'/><rotate "
    "x='1' "
    "angle='-90'/></transform><bsdf type='diffuse'><rgb name='reflectance' value='.6, .5, "
    ".3'/></bsdf></shape>\n";

/// Groups within groups, turned, stretched and mirrored, of cylinders, meshes and a light.
SceneText groups() {
  return converted("converted_groups", "scene.xml",
                   std::string("<scene version='0.6.0'>\n") + kView +
                       R"(<shape type="shapegroup" id="post">
<shape type="cylinder"><float name="radius" value=".1"/><point name="p0" x="0" y="0" z="0"/><point name="p1" x="0" y=".8" z="0"/>
<bsdf type="twosided"><bsdf type="roughconductor"><string name="material" value="none"/><float name="alpha" value=".2"/></bsdf></bsdf></shape>
<shape type="cube"><transform name="toWorld"><scale value=".2"/><translate y=".2"/></transform><bsdf type="diffuse"><rgb name="reflectance" value=".2, .6, .3"/></bsdf></shape>
</shape>
<shape type="shapegroup" id="pair">
<shape type="instance"><ref id="post"/><transform name="toWorld"><translate x="-.4"/></transform></shape>
<shape type="instance"><ref id="post"/><transform name="toWorld"><scale x="-1"/><rotate y="1" angle="30"/><translate x=".4"/></transform></shape>
</shape>
<shape type="instance"><ref id="pair"/></shape>
<shape type="instance"><ref id="pair"/><transform name="toWorld"><scale value="1.5"/><rotate y="1" angle="50"/><translate z="-1"/></transform></shape>
<shape type="rectangle"><transform name="toWorld"><scale value=".6"/><rotate x="1" angle="90"/><translate y="2.2"/></transform>
<emitter type="area"><rgb name="radiance" value="6, 5, 4"/></emitter></shape>
</scene>
)",
                   {});
}

/// Lights with pictures: a rectangle, a cylinder, a spot and a projector.
SceneText textured_lights() {
  SceneText scene = converted(
      "converted_textured_lights", "scene.xml",
      std::string("<scene version='0.6.0'>\n") + kView +
          R"(<texture type="bitmap" id="picture"><string name="filename" value="picture.ppm"/><string name="filterType" value="nearest"/></texture>
<shape type="rectangle"><transform name="toWorld"><scale value=".6"/><translate y="1" z="-1"/></transform><emitter type="area"><ref name="radiance" id="picture"/></emitter></shape>
<shape type="cylinder"><float name="radius" value=".2"/><point name="p0" x="1" y=".3" z="0"/><point name="p1" x="1" y="1.2" z="0"/>
<emitter type="area"><ref name="radiance" id="picture"/></emitter></shape>
<emitter type="spot"><transform name="toWorld"><lookat origin="-1, 2, 1" target="-1, 0, .5" up="0, 0, 1"/></transform>
<spectrum name="intensity" value="3, 3, 3"/><float name="cutoffAngle" value="25"/><ref name="texture" id="picture"/></emitter>
<emitter type="constant"><rgb name="radiance" value=".1, .15, .2"/></emitter>
</scene>
)",
      {{"picture.ppm", picture()}});
  scene.colour_error = 0x1p-11;  // Mitsuba keeps texels of 8 bit as halves
  return scene;
}

}  // namespace

std::vector<SceneText> converted_scenes() {
  return {nori(), pbrt(), tinyrender(), gltf(), groups(), textured_lights()};
}

}  // namespace penumbra::differential
