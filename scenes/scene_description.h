// What to render, as plain values. Every scene reader produces this form, and the device scene is built from
// it. It knows no file formats. Types that become a record of the kernels unchanged say so. Colours are
// linear Rec. 709 RGB; lengths are in scene units; angles are in degrees. Transforms apply to column vectors
// (p' = M p) and are in double precision, so that scenes far from the origin keep their precision.
#pragma once

#include <array>
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
#include "scenes/curves.h"
#include "scenes/emitters.h"
#include "scenes/film_format.h"
#include "scenes/integrators.h"
#include "scenes/media.h"
#include "scenes/textures.h"

namespace penumbra {

/// A triangle mesh in world space. The geometric normal of triangle (a, b, c) is along (b - a) x (c - a).
struct Mesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;    ///< one unit normal per position, or empty: faceted
  std::vector<glm::vec2> texcoords;  ///< one per position, or empty
  std::vector<glm::vec3> colours{};  ///< linear, one per position, or empty
  std::vector<glm::uvec3> triangles;
  std::vector<glm::vec3> face_colours{};  ///< linear, one per triangle, or empty
  /// Of the corners of each triangle: a tangent of any length, or 0 for that of the triangle's texture
  /// coordinates, and in w the sign of the bitangent sign * cross(normal, tangent). Empty: all are those of
  /// texture coordinates.
  std::vector<std::array<glm::vec4, 3>> tangents{};
  bool computes_tangents = false;  ///< tangents are MikkTSpace's, once the mesh is in its place
};

/// The front, which emits, is the outside unless `Shape::flip_normals`.
struct Sphere {
  glm::dvec3 center{0.0};
  double radius = 1.0;
  /// Unit axes of the sphere's own frame, which may be mirrored. They orient the texture coordinates. The
  /// poles lie along z.
  glm::dvec3 x_axis{1.0, 0.0, 0.0}, y_axis{0.0, 1.0, 0.0}, z_axis{0.0, 0.0, 1.0};
};

struct Disk {
  glm::dvec3 center{0.0};
  glm::dvec3 normal{0.0, 0.0, 1.0};  ///< unit; points to the front side
  double radius = 1.0;
  glm::dvec3 x_axis{1.0, 0.0, 0.0}, y_axis{0.0, 1.0, 0.0};  ///< unit axes of its own frame, in its plane
};

/// A cylinder without caps. The front, which emits, is the outside unless `Shape::flip_normals`.
struct Cylinder {
  glm::dvec3 center{0.0};          ///< centre of its first end
  glm::dvec3 axis{0.0, 0.0, 1.0};  ///< unit, from the first end to the other
  double radius = 1.0, length = 1.0;
  /// Unit axes of its own frame, perpendicular to the axis.
  glm::dvec3 x_axis{1.0, 0.0, 0.0}, y_axis{0.0, 1.0, 0.0};
};

using Geometry = std::variant<Mesh, Sphere, Disk, Cylinder, Curves>;

struct Shape {
  std::string name;  ///< for messages
  std::string id{};  ///< the id in the scene file; may be empty
  Geometry geometry;
  int front_bsdf = kBlackBsdf;  ///< index into SceneDescription::bsdfs; kBlackBsdf absorbs everything
  int back_bsdf = kBlackBsdf;
  std::optional<glm::vec3> radiance;  ///< radiance of diffuse emission from the front side
  /// Multiplies the radiance: an index into SceneDescription::textures, or kNoTexture.
  int radiance_texture = kNoTexture;
  bool two_sided_emission = false;  ///< emits from the back as well (meshes and disks only)
  /// Rays do not meet the emission, as where a mask with opacity 0 cuts the shape away: it lights other
  /// shapes, but neither the camera nor a mirror sees it.
  bool unseen_emission = false;
  bool camera_sees_emission = true;  ///< false: camera rays add none, whatever they meet there
  double emission_spread = 180.0;  ///< degrees, of the cone that a flat shape shines into, see light_spread.h
  [[nodiscard]] bool has_spread() const { return emission_spread < 180.0; }
  /// How points on an emitter are sampled; kAuto: as the integrator chooses.
  EmitterSampling sampling = EmitterSampling::kAuto;
  bool flip_normals = false;  ///< swaps front and back
  /// Normal maps follow the signs of the mesh's tangents, so that they are mirrored where the texture is.
  bool mirrors_maps = false;
  /// The medium behind the front side: an index into SceneDescription::media, or kNoMedium.
  int interior = kNoMedium;
  int exterior = kNoMedium;  ///< the medium before the front side, likewise
  std::string material{};    ///< the material's name in the scene file; empty: the names of its BSDFs
};

/// An instance: one placement of a group of shapes.
struct ShapeInstance {
  std::string name;  ///< for messages
  int group = 0;     ///< index into SceneDescription::groups
  glm::dmat4 to_world{1.0};
  bool hidden = false;  ///< it is not there, as at a time at which it has no size
};

/// A group of shapes and of instances of other groups. It is rendered only where an instance places it.
struct ShapeGroup {
  std::string name;  ///< for messages
  std::vector<Shape> shapes;
  std::vector<ShapeInstance> instances;  ///< instances of groups with smaller indices
};

enum class FilterKind { kBox, kTent, kGaussian, kMitchell, kLanczos };

enum class PixelFormat { kRgb, kRgba };

/// How the image is denoised. Except for kOff, the render has the layers that this needs; kLayers: nothing
/// else.
enum class Denoise { kOff, kLayers, kNlMeans, kNfor, kOidn };

/// Layers that an image has only if they are asked for.
enum class AskedLayer { kPosition, kUv, kGeometricNormal, kShape, kDirect, kIndirect, kMotion };

struct Film {
  int width = 768;
  int height = 576;
  int crop_x = 0, crop_y = 0;
  int crop_width = 768, crop_height = 576;
  FilterKind filter = FilterKind::kGaussian;
  /// half-width in pixels; box: 0.5, tent: 1, Gaussian: 4 standard deviations, Mitchell: 2, Lanczos: number
  /// of lobes
  float filter_radius = 2.0f;
  float filter_stddev = 0.5f;      ///< standard deviation of the Gaussian, in pixels
  float filter_b = 1.0f / 3.0f;    ///< Mitchell-Netravali B
  float filter_c = 1.0f / 3.0f;    ///< Mitchell-Netravali C
  bool closed_light_edges = true;  ///< visible edges of lights are integrated without noise where possible
  bool alpha = false;              ///< the image has an alpha channel
  Denoise denoise = Denoise::kOff;
  std::vector<AskedLayer> layers{};  ///< ascending, each once
  bool half = false;                 ///< colours in EXR files have 16 bits
  ExrCompression compression = ExrCompression::kZip;
};

/// Whether a denoised image is written.
inline bool is_denoised(const Film& film) {
  return film.denoise != Denoise::kOff && film.denoise != Denoise::kLayers;
}

enum class SamplerKind { kIndependent, kStratified, kHalton, kSobol };

struct SamplerSettings {
  SamplerKind kind = SamplerKind::kSobol;
  std::uint32_t spp = 16;  ///< samples per pixel
  std::uint32_t seed = 0;
};

/// Everything that settings can change (settings.h).
struct RenderSettings {
  CameraSettings camera;
  Film film;
  SamplerSettings sampler;
  IntegratorSettings integrator;
};

struct SceneMotion;

constexpr double kFramesPerSecond = 24.0;  ///< unless another number is asked for

struct SceneDescription : RenderSettings {
  std::string source;                        ///< the file it was read from
  std::vector<std::filesystem::path> files;  ///< all files that were read for the scene, the scene file first
  /// Hash of the contents of those files. It does not depend on their paths.
  std::uint64_t contents_hash = 0;
  std::string dialect;  ///< for a format with several dialects: the dialect, and how it was recognised
  std::vector<SceneTexture> textures;  ///< a texture may refer only to textures with smaller indices
  std::vector<std::shared_ptr<const Bitmap>> bitmaps;  ///< the images of textures, without duplicates
  std::vector<Bsdf> bsdfs;                             ///< a BSDF may hold only BSDFs with smaller indices
  std::vector<ParticipatingMedium> media;
  /// The medium that contains the camera: an index into `media`, or kNoMedium.
  int camera_medium = kNoMedium;
  std::vector<Shape> shapes;
  std::vector<ShapeGroup> groups;
  std::vector<ShapeInstance> instances;
  std::vector<Emitter> emitters;  ///< emitters that are not shapes; at most one environment
  /// What moves (motion/scene_motion.h); null: nothing does. The scene shows everything at `time`.
  std::shared_ptr<const SceneMotion> motion;
  double time = 0.0;                               ///< in seconds
  double frame_duration = 1.0 / kFramesPerSecond;  ///< from one frame to the next, in seconds
  std::optional<double> fps = {};                  ///< frames per second that the file names
  bool uses_variables = false;                     ///< it depends on one of ReadOptions::variables
  std::vector<std::string>
      warnings;  ///< what the reader repaired or replaced, each with its location in the file
};

}  // namespace penumbra
