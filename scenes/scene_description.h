// What to render, as plain values: the one form that every scene reader produces and that the device scene is
// built from. No device types, no file formats. Colours are linear Rec. 709 RGB; lengths are in the scene's
// own unit; angles in degrees; transforms are column vectors' (p' = M p), in double so that far-away scenes
// keep their precision.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace penumbra {

/// Lambertian reflection, f = reflectance / pi.
struct DiffuseBsdf {
  glm::vec3 reflectance{0.5f};
};

/// Normalised Phong, f = diffuse / pi + specular (n + 2) / (2 pi) max(0, cos(alpha))^n, alpha being the angle
/// between `wi` and the mirror direction of `wo`.
struct PhongBsdf {
  glm::vec3 diffuse{0.5f};
  glm::vec3 specular{0.2f};
  float exponent = 30.0f;  ///< n >= 0
};

struct Bsdf {
  std::string name;  ///< the file's id, or a description of the place, for messages
  std::variant<DiffuseBsdf, PhongBsdf> model;
};

/// World-space triangles. The geometric normal of (a, b, c) is along (b - a) x (c - a).
struct Mesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;    ///< one for each position, unit, or empty: faceted
  std::vector<glm::vec2> texcoords;  ///< one for each position, or empty
  std::vector<glm::uvec3> triangles;
};

/// The front (emitting) side is outside unless `Shape::flip_normals`.
struct Sphere {
  glm::dvec3 center{0.0};
  double radius = 1.0;
};

struct Disk {
  glm::dvec3 center{0.0};
  glm::dvec3 normal{0.0, 0.0, 1.0};  ///< unit; the front side
  double radius = 1.0;
};

constexpr int kBlackBsdf = -1;

/// How a point on an area light is chosen: uniformly by area, by solid angle (rectangles, triangles and
/// spheres; disks by area), by projected solid angle (meshes; others by solid angle), or what is best for the
/// integrator.
enum class EmitterSampling { kAuto, kArea, kSolidAngle, kProjected };

struct Shape {
  std::string name;  ///< for messages
  std::variant<Mesh, Sphere, Disk> geometry;
  int front_bsdf = kBlackBsdf;  ///< index into SceneDescription::bsdfs; kBlackBsdf absorbs everything
  int back_bsdf = kBlackBsdf;
  std::optional<glm::vec3> radiance;                  ///< diffuse area emission from the front side
  bool two_sided_emission = false;                    ///< emits from the back as well (meshes and disks)
  EmitterSampling sampling = EmitterSampling::kAuto;  ///< of an emitter; kAuto: as the integrator says
  bool flip_normals = false;                          ///< swaps front and back
};

/// Radiant intensity, W/sr, the same in all directions.
struct PointLight {
  glm::dvec3 position{0.0};
  glm::vec3 intensity{1.0f};
};

/// Constant radiance from all directions that leave the scene.
struct ConstantEnvironment {
  glm::vec3 radiance{1.0f};
};

enum class FovAxis { kX, kY, kDiagonal, kSmaller, kLarger };

/// Camera space looks along +z with +y up and +x to the left of the image (Mitsuba's convention).
struct PerspectiveCamera {
  glm::dmat4 to_world{1.0};  ///< camera to world; a scale has no effect on directions
  double fov =
      50.0;  ///< full angle, degrees, in (0, 180), along `fov_axis`, of the whole film (not of the crop)
  FovAxis fov_axis = FovAxis::kX;
  double near_clip = 1e-2;  ///< distances along +z; nothing outside is seen by the camera
  double far_clip = 1e4;
};

enum class FilterKind { kBox, kTent, kGaussian, kMitchell };

struct Film {
  int width = 768;
  int height = 576;
  int crop_x = 0, crop_y = 0;
  int crop_width = 768, crop_height = 576;
  FilterKind filter = FilterKind::kGaussian;
  float filter_radius = 2.0f;    ///< half-width in pixels; box .5, tent 1, gaussian 4 stddev, Mitchell 2
  float filter_stddev = 0.5f;    ///< Gaussian
  float filter_b = 1.0f / 3.0f;  ///< Mitchell-Netravali B
  float filter_c = 1.0f / 3.0f;  ///< Mitchell-Netravali C
};

enum class SamplerKind { kIndependent, kStratified, kHalton, kSobol };

struct SamplerSettings {
  SamplerKind kind = SamplerKind::kSobol;
  std::uint32_t spp = 16;  ///< samples per pixel
  std::uint32_t seed = 0;
};

/// kPolygonAnalytic: unshadowed light of the polygon lights in closed form; kPolygonArea: samples of emitters
/// by area; kPolygonCv: samples of emitters with the closed form as control variate.
enum class IntegratorKind { kDirect, kPath, kPolygonAnalytic, kPolygonArea, kPolygonCv };
enum class DirectSampling { kBsdfOnly, kEmitterOnly, kMis };  ///< path: "mats", "ems", "mis"
enum class MisHeuristic { kBalance, kPower };                 ///< power: beta = 2
enum class BsdfSampling { kBsdf, kCosine, kUniform };  ///< how direct's `bsdf_samples` choose directions
/// How samples and the closed form of polygon lights are put together: alpha G + <H - alpha G>, or G <H> /
/// <G>.
enum class CvEstimator { kCv, kRatio };
enum class NextEvent { kSample, kCv };  ///< path: kCv has polygon lights' closed form as control variate
/// How one of many lights is chosen: in proportion to its power, or to its unshadowed contribution to the
/// point.
enum class LightChoice { kAuto, kPower, kAnalytic };

/// What the camera sees where an emitter is hidden: its surface without its light, as Mitsuba up to 3.6 has
/// it, or what is behind it, as later ones.
enum class HiddenEmitters { kUnlit, kLookedThrough };

struct IntegratorSettings {
  IntegratorKind kind = IntegratorKind::kPath;
  int max_depth =
      -1;  ///< path: longest path in edges (1: emitters seen directly; 2: direct light); -1: no limit
  int rr_depth = 5;                                       ///< path: Russian roulette from this depth on
  DirectSampling direct_sampling = DirectSampling::kMis;  ///< path
  int emitter_samples = 1;                                ///< direct: n_g, shadow rays per camera ray
  int bsdf_samples = 1;                                   ///< direct: n_f, BSDF-sampled rays per camera ray
  BsdfSampling bsdf_sampling = BsdfSampling::kBsdf;       ///< direct
  EmitterSampling emitter_sampling = EmitterSampling::kAuto;  ///< both
  MisHeuristic heuristic = MisHeuristic::kBalance;            ///< both
  LightChoice light_choice = LightChoice::kAuto;              ///< all
  bool trace_shadows = true;                                  ///< direct, polygon_area
  int vis_samples = 1;                                        ///< polygon_cv: shadow rays per camera ray
  std::optional<float> alpha = std::nullopt;                  ///< polygon_cv, path with kCv; none: auto
  CvEstimator estimator = CvEstimator::kCv;                   ///< polygon_cv, path with kCv
  NextEvent next_event = NextEvent::kSample;                  ///< path
  bool hide_emitters = false;
  HiddenEmitters hidden_emitters = HiddenEmitters::kUnlit;  ///< with hide_emitters
};

/// Whether samples of polygon lights have their closed form as control variate.
inline bool has_control_variate(const IntegratorSettings& integrator) {
  return integrator.kind == IntegratorKind::kPolygonCv ||
         (integrator.kind == IntegratorKind::kPath && integrator.next_event == NextEvent::kCv);
}

struct SceneDescription {
  std::string source;                        ///< the file it was read from
  std::vector<std::filesystem::path> files;  ///< all that were read for it, that one first
  /// Of the contents of those files: the same scene elsewhere has the same.
  std::uint64_t contents_hash = 0;
  std::vector<Bsdf> bsdfs;
  std::vector<Shape> shapes;
  std::vector<PointLight> point_lights;
  std::optional<ConstantEnvironment> environment;
  PerspectiveCamera camera;
  Film film;
  SamplerSettings sampler;
  IntegratorSettings integrator;
  std::vector<std::string>
      warnings;  ///< what the reader repaired or stood in for, each with its file position
};

}  // namespace penumbra
