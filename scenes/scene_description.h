// What to render, as plain values: the one form that every scene reader produces and that the device scene is
// built from. No file formats; what becomes a record of the kernels as it is says so beside it. Colours are
// linear Rec. 709 RGB; lengths are in the scene's own unit; angles in degrees; transforms are column vectors'
// (p' = M p), in double so that far-away scenes keep their precision.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scenes/bsdfs.h"
#include "scenes/cameras.h"
#include "scenes/emitters.h"
#include "scenes/film_format.h"
#include "scenes/integrators.h"
#include "scenes/media.h"
#include "scenes/textures.h"

namespace penumbra {

/// World-space triangles. The geometric normal of (a, b, c) is along (b - a) x (c - a).
struct Mesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;    ///< one for each position, unit, or empty: faceted
  std::vector<glm::vec2> texcoords;  ///< one for each position, or empty
  std::vector<glm::vec3> colours{};  ///< linear, one for each position, or empty
  std::vector<glm::uvec3> triangles;
  std::vector<glm::vec3> face_colours{};  ///< linear, one for each triangle, or empty
};

/// The front (emitting) side is outside unless `Shape::flip_normals`.
struct Sphere {
  glm::dvec3 center{0.0};
  double radius = 1.0;
  /// Unit axes of its own frame, mirrored or not: texture coordinates turn with it. The poles lie along z.
  glm::dvec3 x_axis{1.0, 0.0, 0.0}, y_axis{0.0, 1.0, 0.0}, z_axis{0.0, 0.0, 1.0};
};

struct Disk {
  glm::dvec3 center{0.0};
  glm::dvec3 normal{0.0, 0.0, 1.0};  ///< unit; the front side
  double radius = 1.0;
  glm::dvec3 x_axis{1.0, 0.0, 0.0}, y_axis{0.0, 1.0, 0.0};  ///< of its own frame, unit, in its plane
};

/// Without caps. The front (emitting) side is outside unless `Shape::flip_normals`.
struct Cylinder {
  glm::dvec3 center{0.0};          ///< of its first end
  glm::dvec3 axis{0.0, 0.0, 1.0};  ///< unit, towards the other end
  double radius = 1.0, length = 1.0;
  glm::dvec3 x_axis{1.0, 0.0, 0.0}, y_axis{0.0, 1.0, 0.0};  ///< of its own frame, unit, across the axis
};

using Geometry = std::variant<Mesh, Sphere, Disk, Cylinder>;

struct Shape {
  std::string name;  ///< for messages
  std::string id{};  ///< that its file gives it; may be empty
  Geometry geometry;
  int front_bsdf = kBlackBsdf;  ///< index into SceneDescription::bsdfs; kBlackBsdf absorbs everything
  int back_bsdf = kBlackBsdf;
  std::optional<glm::vec3> radiance;                  ///< diffuse area emission from the front side
  int radiance_texture = kNoTexture;                  ///< by which it is multiplied: an index, or kNoTexture
  bool two_sided_emission = false;                    ///< emits from the back as well (meshes and disks)
  EmitterSampling sampling = EmitterSampling::kAuto;  ///< of an emitter; kAuto: as the integrator says
  bool flip_normals = false;                          ///< swaps front and back
  int interior = kNoMedium;  ///< behind the front side: an index into SceneDescription::media, or kNoMedium
  int exterior = kNoMedium;  ///< likewise before it
  std::string material{};  ///< the name that its file gives to what it is made of; empty: those of its BSDFs
};

/// A group of shapes in a place.
struct ShapeInstance {
  std::string name;  ///< for messages
  int group = 0;     ///< index into SceneDescription::groups
  glm::dmat4 to_world{1.0};
};

/// Shapes that are in the scene, or in another group, wherever an instance of the group is, and nowhere else.
struct ShapeGroup {
  std::string name;  ///< for messages
  std::vector<Shape> shapes;
  std::vector<ShapeInstance> instances;  ///< of groups that come before it
};

enum class FilterKind { kBox, kTent, kGaussian, kMitchell, kLanczos };

enum class PixelFormat { kRgb, kRgba };

struct Film {
  int width = 768;
  int height = 576;
  int crop_x = 0, crop_y = 0;
  int crop_width = 768, crop_height = 576;
  FilterKind filter = FilterKind::kGaussian;
  float filter_radius = 2.0f;      ///< half-width in pixels; box .5, tent 1, gaussian 4 stddev, Mitchell 2,
                                   ///< Lanczos its lobes
  float filter_stddev = 0.5f;      ///< Gaussian
  float filter_b = 1.0f / 3.0f;    ///< Mitchell-Netravali B
  float filter_c = 1.0f / 3.0f;    ///< Mitchell-Netravali C
  bool closed_light_edges = true;  ///< edges of lights that are seen are without noise, where they can be
  bool alpha = false;              ///< the image has an alpha channel
  bool half = false;               ///< colours in its EXR have 16 bits
  ExrCompression compression = ExrCompression::kZip;
};

enum class SamplerKind { kIndependent, kStratified, kHalton, kSobol };

struct SamplerSettings {
  SamplerKind kind = SamplerKind::kSobol;
  std::uint32_t spp = 16;  ///< samples per pixel
  std::uint32_t seed = 0;
};

/// What settings change (settings.h).
struct RenderSettings {
  CameraSettings camera;
  Film film;
  SamplerSettings sampler;
  IntegratorSettings integrator;
};

struct SceneDescription : RenderSettings {
  std::string source;                        ///< the file it was read from
  std::vector<std::filesystem::path> files;  ///< all that were read for it, that one first
  /// Of the contents of those files: the same scene elsewhere has the same.
  std::uint64_t contents_hash = 0;
  std::string dialect;                 ///< of a format that has several: which, and what told it
  std::vector<SceneTexture> textures;  ///< one holds only such as come before it
  std::vector<std::shared_ptr<const Bitmap>> bitmaps;  ///< of textures, each once
  std::vector<Bsdf> bsdfs;                             ///< one holds only such as come before it
  std::vector<ParticipatingMedium> media;
  int camera_medium = kNoMedium;  ///< in which the camera is: an index into `media`, or kNoMedium
  std::vector<Shape> shapes;
  std::vector<ShapeGroup> groups;
  std::vector<ShapeInstance> instances;
  std::vector<Emitter> emitters;  ///< lights that are no shapes; one sky at most
  std::vector<std::string>
      warnings;  ///< what the reader repaired or stood in for, each with its file position
};

}  // namespace penumbra
