#include "scheduler/estimate/scene_contents.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <glm/trigonometric.hpp>
#include <string_view>
#include <variant>

#include "kernels/host/text.h"
#include "scenes/cameras.h"
#include "scenes/instances.h"
#include "scenes/panoramas.h"
#include "scheduler/render/frames.h"

namespace penumbra {
namespace {

std::string place_text(const glm::dvec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

std::size_t triangles_of(const Shape& shape) {
  const auto* mesh = std::get_if<Mesh>(&shape.geometry);
  return mesh == nullptr ? 0 : mesh->triangles.size();
}

const char* kind_of(const Shape& shape) {
  if (std::holds_alternative<Mesh>(shape.geometry)) return "meshes";
  if (std::holds_alternative<Sphere>(shape.geometry)) return "spheres";
  if (std::holds_alternative<Curves>(shape.geometry)) return "curves";
  return std::holds_alternative<Disk>(shape.geometry) ? "disks" : "cylinders";
}

void count_geometry(const SceneDescription& scene, std::span<const PlacedGroup> placed,
                    SceneContents& contents) {
  each_shape(scene, [&](const Shape& shape) {
    ++contents.geometry[kind_of(shape)];
    contents.triangles += triangles_of(shape);
  });
  for (const Shape& shape : scene.shapes) {
    contents.placed_triangles += triangles_of(shape);
    if (emits(shape)) ++contents.lights["area"];
  }
  // Number of triangles and area lights of each group.
  std::vector<std::pair<std::size_t, std::size_t>> groups;
  for (const ShapeGroup& group : scene.groups) {
    auto& [triangles, lights] = groups.emplace_back();
    for (const Shape& shape : group.shapes) {
      triangles += triangles_of(shape);
      lights += emits(shape) ? 1 : 0;
    }
  }
  for (const PlacedGroup& place : placed) {
    const auto& [triangles, lights] = groups[std::size_t(place.group)];
    contents.placed_triangles += triangles;
    if (lights > 0) contents.lights["area"] += lights;
  }
}

NamedTexts camera_text(const CameraFacts& camera) {
  NamedTexts texts = {{"position", place_text(camera.position)},
                      {"direction", place_text(camera.direction)},
                      {"up", place_text(camera.up)}};
  if (is_panorama(camera.projection))
    texts.emplace_back("projection", projection_name(camera.projection));
  else if (camera.projection == Projection::kOrthographic)
    texts.emplace_back("view", fmt::format("orthographic, {:.6g} x {:.6g}", camera.across, camera.down));
  else
    texts.emplace_back("field of view",
                       fmt::format("{:.4g} degrees across, {:.4g} down", camera.across, camera.down));
  texts.emplace_back("aperture", camera.aperture_radius > 0
                                     ? fmt::format("radius {:.6g}, in focus at distance {:.6g}",
                                                   camera.aperture_radius, camera.focus_distance)
                                     : "none: a pinhole");
  return texts;
}

std::optional<std::pair<std::int64_t, std::int64_t>> frame_range(const MotionFacts& motion) {
  return motion.times ? frames_between(*motion.times, kFramesPerSecond) : std::nullopt;
}

std::string exposure_text(const MotionFacts& motion) {
  const Exposure& e = motion.exposure;
  const double whole = e.close - e.open;
  if (!(whole > 0.0)) return "of one instant";
  std::string text = fmt::format("{:.6g} s, from {:.6g} to {:.6g} s, curve {}, frame's time at the {}",
                                 whole * e.exposure, e.open, e.close, motion.curve, motion.position);
  if (e.rolling > 0.0) text += fmt::format("; the last row starts {:.6g} s later", whole * e.rolling);
  return text;
}

NamedTexts motion_text(const MotionFacts& motion) {
  NamedTexts texts;
  for (const Clip& clip : motion.clips)
    texts.emplace_back(
        fmt::format("clip '{}'", clip.name),
        fmt::format("{:.6g} to {:.6g} s{}", clip.first, clip.last, clip.is_shown ? ", shown" : ""));
  if (motion.times)
    texts.emplace_back("time", fmt::format("{:.6g} to {:.6g} s, shown at {:.6g} s", motion.times->first,
                                           motion.times->second, motion.time));
  if (const auto frames = frame_range(motion))
    texts.emplace_back(
        "frames", fmt::format("{} to {}, {:.6g} a second", frames->first, frames->second, kFramesPerSecond));
  texts.emplace_back("exposure", exposure_text(motion));
  const auto put = [&](const char* what, const MotionFacts::Share& share) {
    if (share.moving > 0) texts.emplace_back(what, fmt::format("{} of {}", share.moving, share.all));
  };
  put("shapes that move", motion.shapes);
  if (motion.meshes_that_deform > 0)
    texts.emplace_back("meshes that deform", fmt::to_string(motion.meshes_that_deform));
  put("instances that move", motion.instances);
  put("lights that move or change", motion.emitters);
  std::vector<std::string> of_camera = motion.camera_numbers;
  if (motion.camera) of_camera.insert(of_camera.begin(), "place");
  if (!of_camera.empty()) texts.emplace_back("camera", fmt::format("{}", fmt::join(of_camera, ", ")));
  return texts;
}

nlohmann::ordered_json motion_json(const MotionFacts& motion) {
  nlohmann::ordered_json json;
  json["clips"] = nlohmann::ordered_json::array();
  for (const Clip& clip : motion.clips)
    json["clips"].push_back(
        {{"name", clip.name}, {"first", clip.first}, {"last", clip.last}, {"shown", clip.is_shown}});
  json["time"] = motion.time;
  if (motion.times) json["times"] = {motion.times->first, motion.times->second};
  json["fps"] = kFramesPerSecond;
  if (const auto frames = frame_range(motion)) json["frames"] = {frames->first, frames->second};
  const Exposure& e = motion.exposure;
  json["exposure"] = {{"open", e.open},
                      {"close", e.close},
                      {"seconds", e.exposure * (e.close - e.open)},
                      {"rolling", e.rolling * (e.close - e.open)},
                      {"position", motion.position},
                      {"curve", motion.curve}};
  json["shapes"] = motion.shapes.moving;
  json["meshes_that_deform"] = motion.meshes_that_deform;
  json["instances"] = motion.instances.moving;
  json["lights"] = motion.emitters.moving;
  json["camera"] = motion.camera;
  json["camera_numbers"] = motion.camera_numbers;
  return json;
}

}  // namespace

CameraFacts camera_facts(const CameraSettings& camera, const Film& film) {
  CameraFacts facts;
  facts.projection = camera.projection;
  facts.position = camera.to_world[3] + 0.0;  // no -0
  facts.direction = glm::normalize(glm::dvec3(camera.to_world[2])) + 0.0;
  facts.up = glm::normalize(glm::dvec3(camera.to_world[1])) + 0.0;
  const HalfFilm half = half_film(camera, film);
  const auto full_angle = [](double tangent) { return glm::degrees(2 * std::atan(tangent)); };
  const bool flat = facts.projection == Projection::kOrthographic;
  if (!is_panorama(facts.projection)) {
    facts.across = flat ? 2 * half.x : full_angle(half.x);
    facts.down = flat ? 2 * half.y : full_angle(half.y);
  }
  facts.aperture_radius = camera.aperture_radius;
  facts.focus_distance = camera.focus_distance;
  return facts;
}

Expected<SceneContents> contents_of(const SceneDescription& scene) {
  const auto placed = place_groups(scene);
  if (!placed) return std::unexpected(placed.error());
  SceneContents contents;
  contents.camera = camera_facts(scene.camera, scene.film);
  contents.motion = motion_facts(scene);
  contents.extent = bounds_of(scene, *placed);
  contents.instances = placed->size();
  count_geometry(scene, *placed, contents);
  for (const Emitter& emitter : scene.emitters)
    std::visit([&]<typename Light>(const Light&) { ++contents.lights[Light::kPlugin]; }, emitter);
  contents.textures = scene.textures.size();
  contents.images = scene.bitmaps.size();
  for (const auto& bitmap : scene.bitmaps)
    contents.image_bytes += bitmap->words.size() * sizeof(std::uint32_t);
  contents.media = scene.media.size();
  contents.emitting_media = std::size_t(std::ranges::count_if(scene.media, &ParticipatingMedium::emits));
  for (const std::filesystem::path& file : scene.files) {
    std::error_code gone;
    const std::uintmax_t bytes = std::filesystem::file_size(file, gone);
    contents.files.emplace_back(file, gone ? 0 : bytes);
  }
  return contents;
}

std::vector<std::pair<std::string, NamedTexts>> contents_text(const SceneContents& contents) {
  const SceneBounds& box = contents.extent;
  const glm::dvec3 size = box.high - box.low;
  NamedTexts geometry = {
      {"extent", fmt::format("{} to {}", place_text(box.low), place_text(box.high))},
      {"size", fmt::format("{:.6g} x {:.6g} x {:.6g}", size.x, size.y, size.z)},
      {"triangles", contents.instances == 0 ? fmt::format("{}", contents.triangles)
                                            : fmt::format("{}, {} with instances", contents.triangles,
                                                          contents.placed_triangles)}};
  for (const auto& [kind, count] : contents.geometry) geometry.emplace_back(kind, fmt::to_string(count));
  if (contents.instances > 0) geometry.emplace_back("instances", fmt::to_string(contents.instances));
  if (contents.media > 0)
    geometry.emplace_back("media",
                          contents.emitting_media == 0
                              ? fmt::to_string(contents.media)
                              : fmt::format("{}, {} of which emit", contents.media, contents.emitting_media));
  NamedTexts textures;
  if (contents.textures > 0) textures.emplace_back("textures", fmt::to_string(contents.textures));
  if (contents.images > 0)
    textures.emplace_back("images",
                          fmt::format("{}, {} in memory", contents.images, size_text(contents.image_bytes)));
  NamedTexts lights;
  for (const auto& [kind, count] : contents.lights) lights.emplace_back(kind, fmt::to_string(count));
  if (lights.empty()) lights.emplace_back("none", "");
  NamedTexts files;
  for (const auto& [path, bytes] : contents.files) files.emplace_back(path.string(), size_text(bytes));
  return {{"Camera", camera_text(contents.camera)},
          {"Motion", contents.motion ? motion_text(*contents.motion) : NamedTexts()},
          {"Geometry", geometry},
          {"Textures", textures},
          {"Lights", lights},
          {"Files", files}};
}

void add_contents(nlohmann::ordered_json& json, const SceneContents& contents) {
  const auto triple = [](const glm::dvec3& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
  const CameraFacts& camera = contents.camera;
  json["camera"] = {{"projection", projection_name(camera.projection)},
                    {"position", triple(camera.position)},
                    {"direction", triple(camera.direction)},
                    {"up", triple(camera.up)}};
  if (camera.projection == Projection::kOrthographic)
    json["camera"]["view"] = {camera.across, camera.down};
  else if (!is_panorama(camera.projection))
    json["camera"]["fov"] = {camera.across, camera.down};
  json["camera"]["aperture_radius"] = camera.aperture_radius;
  if (camera.aperture_radius > 0) json["camera"]["focus_distance"] = camera.focus_distance;
  if (contents.motion) json["motion"] = motion_json(*contents.motion);
  const SceneBounds& box = contents.extent;
  json["extent"] = {
      {"low", triple(box.low)}, {"high", triple(box.high)}, {"size", triple(box.high - box.low)}};
  json["geometry"] = contents.geometry;
  json["instances"] = contents.instances;
  json["triangles_with_instances"] = contents.placed_triangles;
  json["textures"] = {
      {"count", contents.textures}, {"images", contents.images}, {"image_bytes", contents.image_bytes}};
  json["media"] = contents.media;
  json["emitting_media"] = contents.emitting_media;
  json["lights_by_kind"] = contents.lights;
  json["files"] = nlohmann::ordered_json::array();
  for (const auto& [path, bytes] : contents.files)
    json["files"].push_back({{"path", path.string()}, {"bytes", bytes}});
}

}  // namespace penumbra
