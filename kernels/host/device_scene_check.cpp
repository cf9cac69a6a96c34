#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/device_scene.h"
#include "kernels/host/hierarchy_check.h"
#include "kernels/host/kernel_needs.h"
#include "kernels/host/measured_check.h"
#include "kernels/host/media_check.h"
#include "kernels/host/record_check.h"
#include "kernels/intersect/bvh_limits.h"
#include "kernels/light/envmap_grid.h"

namespace penumbra {
namespace {

// How many records of each table kernels read, whatever its count.
enum {
#define LEAST_RECORDS(_, name, record, least, what) LEAST_##name = least,
  SCENE_TABLES(LEAST_RECORDS, _)
#undef LEAST_RECORDS
};

class Checker : public RecordCheck {
 public:
  using RecordCheck::RecordCheck;

  Expected<void> run() {
    check_header();
    if (problem_.empty()) check_tables();
    if (problem_.empty()) check_records();
    if (problem_.empty()) check_search();
    if (!problem_.empty()) return fail("device scene: " + problem_);
    return {};
  }

 private:
  void check_header() {
    require((h_.features & ~std::uint64_t(FEATURE_ALL)) == 0, "unknown features");
    require((h_.light_kinds & ~ALL_LIGHT_KINDS) == 0, "unknown kinds of lights");
    require((h_.families & ~kEveryFamily) == 0, "unknown families of BSDFs");
    require(in(h_.intersector, INTERSECTOR_PORTABLE, INTERSECTOR_EMBREE), "unknown intersector");
    require(in(h_.sampler.kind, SAMPLER_INDEPENDENT, SAMPLER_SOBOL), "unknown sampler");
    require(in(h_.film.filter, FILTER_BOX, FILTER_TABULATED), "unknown filter");
    check_camera();
    require(in(h_.integrator.kind, INTEGRATOR_DIRECT, INTEGRATOR_OCCLUSION), "unknown integrator");
    require(h_.film.width > 0 && h_.film.height > 0, "empty film");
    require(h_.film.sky_coverage >= 0 && h_.film.sky_coverage <= 1, "a sky that covers no share");
    require(h_.sampler.spp > 0, "no samples per pixel");
    require(h_.integrator.rr_depth >= 0, "Russian roulette begins before the path");
    require(in(h_.integrator.emitter_samples, 0, MAX_DIRECT_SAMPLES) &&
                in(h_.integrator.bsdf_samples, 0, MAX_DIRECT_SAMPLES),
            "an implausible number of emitter or BSDF samples");
    require(in(h_.integrator.estimator, ESTIMATOR_SAMPLES, ESTIMATOR_AUTO), "unknown estimator");
    require(in(h_.integrator.bsdf_sampling, DIRECTION_BSDF, DIRECTION_LOBE), "unknown density of directions");
    require(in(h_.integrator.branch_depth, 0, MAX_BRANCH_DEPTH), "paths branch too often");
    require(h_.integrator.kind != INTEGRATOR_OCCLUSION || h_.integrator.emitter_samples > 0,
            "no rays that anything could block");
    require(in(h_.integrator.hide_emitters, HIDE_MARKED, HIDE_LOOK_THROUGH), "unknown way to hide emitters");
    require(in(h_.integrator.light_choice, CHOICE_POWER, CHOICE_TREE), "unknown choice of lights");
  }

  void check_camera() {
    const Camera& c = h_.camera;
    const bool plain = c.parallel == 0 && c.offset_x == 0 && c.offset_y == 0 && c.lens_radius == 0 &&
                       c.reach == 0 && c.split == 0 && c.panorama == 0;
    require(plain || has(FEATURE_CAMERA), "a camera with a lens without its feature bit");
    if (!has(FEATURE_CAMERA)) return;
    const auto positive = [](const vec3& v) { return v.x > 0 && v.y > 0 && v.z > 0; };
    require((c.parallel == 0 || c.parallel == 1) && (c.split == 0 || c.split == 1),
            "a camera of unknown kind");
    const auto finite = [](auto... numbers) { return (std::isfinite(numbers) && ...); };
    require(c.lens_radius >= 0 && positive(c.focus) && positive(c.image_scale) &&
                finite(c.lens_radius, c.image_scale.x, c.image_scale.y, c.image_scale.z),
            "a camera with an implausible lens");
    require((c.blades == 0 || c.blades >= 3) && c.blades <= 1024 && c.blades == std::floor(c.blades) &&
                c.blade_turn >= 0 && c.blade_turn <= 1,
            "a lens with implausible blades");
    require(c.reach >= 0 && finite(c.reach, c.k1, c.k2), "an implausible distortion");
    require(finite(c.offset_x, c.offset_y), "a camera whose axis beside the film is nowhere");
    require((c.panorama != 0) == has(FEATURE_PANORAMA), "a panorama without its feature bit");
    if (c.panorama == 0) return;
    require(
        c.panorama >= 1 && c.panorama <= float(PANORAMA_EQUAL_AREA) && c.panorama == std::floor(c.panorama),
        "an unknown panorama");
    require(c.pictures == 1 ||
                (c.pictures == 2 && c.panorama == float(PANORAMA_EQUIRECTANGULAR) && h_.film.height % 2 == 0),
            "a film that is no pair of pictures");
    check_panorama(c);
  }

  /// What a panorama's film shows: no more than the sphere, see PANORAMA_*, but for roundings.
  void check_panorama(const Camera& c) {
    constexpr float kTurns = 2, kRound = 1 + 1e-5f;  // 720 degrees
    const auto finite = [](auto... numbers) { return (std::isfinite(numbers) && ...); };
    bool plausible = finite(c.center_x, c.center_y, c.half_x, c.half_y, c.limit, c.eye) && c.half_x > 0 &&
                     c.half_y > 0 && c.limit >= 0 && c.eye >= 0;
    const float most_y = std::abs(c.center_y) + c.half_y;
    switch (int(c.panorama)) {
      case PANORAMA_EQUIRECTANGULAR:
        plausible &= std::abs(c.center_x) <= kTurns && c.half_x <= 0.5f * kRound && most_y <= 0.25f * kRound;
        break;
      case PANORAMA_CYLINDRICAL:
        plausible &= std::abs(c.center_x) <= kTurns && c.half_x <= 0.5f * kRound && most_y <= 1e6f * kRound;
        break;
      case PANORAMA_EQUIDISTANT:
        plausible &= c.center_x == 0 && c.center_y == 0 && c.limit > 0 && c.limit <= 0.5f * kRound;
        break;
      case PANORAMA_EQUISOLID:
        plausible &= c.center_x == 0 && c.center_y == 0 && c.limit > 0 && c.limit <= kRound;
        break;
      default:
        plausible &= c.center_x == 0 && c.center_y == 0 && c.half_x == 1 && c.half_y == 1;
    }
    plausible &= c.eye == 0 || c.pictures == 2;
    require(plausible, "an implausible panorama");
  }

  void check_tables() {
    for (const SceneTable& each : kSceneTables) {
      const TableSpan span = h_.tables.*each.span;
      const std::uint64_t records = std::uint64_t(std::max(span.count, each.least));
      if (span.count >= 0 && span.offset + records * (each.record_bytes / 4) <= scene_.words.size()) continue;
      problem_ = fmt::format(
          "the table '{}' lies outside the data: {} records of {} bytes from word {} on, where there are {} "
          "words",
          each.what, span.count < 0 ? span.count : std::int64_t(records), each.record_bytes, span.offset,
          scene_.words.size());
      return;
    }
  }

  static TableSpan at_least_one(TableSpan span) { return {std::max(span.count, 1), span.offset}; }

  /// Checks every record of `from`, and those that kernels read of an empty table: the member is an index
  /// into `to`, and at least `least`.
  template <typename Record>
  void check_index(TableSpan from, int least_from, int Record::*member, TableSpan to, int least_to, int least,
                   const char* what) {
    const int last = (from.count > 0 ? to.count : std::max(to.count, least_to)) - 1;
    from.count = std::max(from.count, least_from);
    for (const Record& record : table<Record>(scene_, from)) require(in(record.*member, least, last), what);
  }

  void check_records() {
    require(h_.tables.materials.count >= 1, "no material");
    for (const Material& m : table<Material>(scene_, h_.tables.materials))
      require(m.family == FAMILY_BLACK || (m.family > 0 && holds(h_.families, m.family)),
              "a material of a family of BSDFs that the header does not name");
    check_material_trees();
    check_photons();
    // Kernels read the curves, and the lobes of phase functions, for lanes that have other materials, too.
    const bool curves = h_.tables.curves.count > 0;
    for (const Material& m : table<Material>(scene_, h_.tables.materials)) {
      const bool measured = m.family == FAMILY_MEASURED;
      const bool uses = holds(USERS_curve & ~EXTRA_FAMILIES, m.family) && !measured;
      const bool film = m.family == FAMILY_OPENPBR_FILM;
      require(in(m.film_rows, film ? 1 : 0, film ? FILM_ROWS : 0) &&
                  (!film || (m.curve_rows > 0 && m.curve_rows % OPENPBR_SETS == 0)),
              "a material with an implausible film");
      const std::int64_t film_size =
          std::int64_t(m.film_rows) *
          (FILM_REFLECTANCES + 3 * CURVE_STRIDE * std::int64_t(m.curve_rows / OPENPBR_SETS));
      require((!curves && !uses && !measured) ||
                  (in(m.curve_rows, uses ? 1 : 0, OPENPBR_SETS * CURVE_ROWS) && m.curve >= 0 &&
                   std::int64_t(m.curve) + std::max(m.curve_rows, 1) * CURVE_STRIDE + film_size <=
                       h_.tables.curves.count),
              "a material names a curve that is not there");
      if (!measured || !problem_.empty()) continue;
      const auto numbers = table<float>(scene_, h_.tables.curves).subspan(std::size_t(m.curve));
      const std::int64_t size = measured_table_size(numbers);
      require(size > 0 && size <= std::int64_t(numbers.size()),
              "a measured BRDF's table does not match its size");
    }
    require(in(h_.environment, -1, h_.tables.lights.count - 1), "the environment names no light");
    require(h_.sun_count == 0 || (in(h_.sun_count, 1, h_.tables.lights.count) &&
                                  in(h_.first_sun, 0, h_.tables.lights.count - h_.sun_count)),
            "the suns name no lights");
#define CHECK_INDEX(name, record, member, target, least, what) \
  check_index(h_.tables.name, LEAST_##name, &record::member, h_.tables.target, LEAST_##target, least, what);
    SCENE_INDICES(CHECK_INDEX)
#undef CHECK_INDEX
    check_light_cells();
    check_uvs();
    check_instances();
    check_mattes();
    check_layers();
    check_motion();
    if (problem_.empty()) problem_ = media_problem(scene_);
    check_textures();
    check_quadrics();
    for (const Light& l : table<Light>(scene_, at_least_one(h_.tables.lights))) {
      require(holds(ALL_LIGHT_KINDS, l.kind), "a light of unknown kind");
      require(h_.tables.lights.count == 0 || holds(h_.light_kinds, l.kind),
              "a light of a kind that the header does not name");
      require(in(l.sampling, EMITTER_AREA, EMITTER_PROJECTED), "a light of unknown sampling");
      require(in(l.start, 0, int(LIGHT_PROBABILITY_STEPS)),
              "a light begins at no number that a sampler can give");
      require(!has(FEATURE_POLYGONS) || in(l.polygon, -1, h_.tables.polygons.count - 1),
              "a light names a polygon that is not there");
      require(l.kind != LIGHT_SUN || h_.tables.lights.count == 0 || (l.area > 0.0f && l.area <= 2.0f),
              "a sun without an angle");
      require(!(l.spread > 0.0f) || h_.tables.lights.count == 0 || has(FEATURE_SPREAD),
              "a light's spread without its feature bit");
      if (l.kind == LIGHT_ENVMAP) check_envmap();
      check_beam(l);
      check_light_texture(l);
    }
    if (has(FEATURE_POLYGONS)) check_polygons();
    if (has(FEATURE_LIGHT_EDGES)) check_light_edges();
    if (has(FEATURE_LIGHT_TREE)) check_light_tree();
    require(has(FEATURE_LIGHT_TREE) == (h_.integrator.light_choice == CHOICE_TREE),
            "the choice of lights by their hierarchy and its feature bit go together");
    require(has(FEATURE_POLYGONS) || (h_.integrator.estimator == ESTIMATOR_SAMPLES &&
                                      h_.integrator.light_choice != CHOICE_ANALYTIC),
            "closed forms without their feature bit");
    require(!has(FEATURE_LTC) || h_.tables.ltc_cells.count == 2 * LTC_SIZE * LTC_SIZE,
            "linearly transformed cosines without their tables");
    require((h_.families & families_with(TRANSMITS) & ~families_with(FREE)) == 0 || has(FEATURE_TRANSMISSION),
            "BSDFs that transmit without their feature bit");
    require((h_.tables.quadrics.count == 0 && h_.tables.quadric_leaves.count == 0) || has(FEATURE_QUADRICS),
            "quadrics without their feature bit");
    constexpr std::uint64_t kIntegrators[] = {FEATURE_DIRECT, FEATURE_PATH, FEATURE_WHITTED,
                                              FEATURE_OCCLUSION};
    require(in(h_.integrator.kind, 0, 3) && has(kIntegrators[h_.integrator.kind]),
            "an integrator without its feature bit");
    require(h_.sampler.kind == SAMPLER_SOBOL || has(FEATURE_SAMPLERS), "a sampler without its feature bit");
  }

  void check_quadrics() {
    const auto quadrics = table<Quadric>(scene_, h_.tables.quadrics);
    const int moving = h_.tables.quadric_motions.count;
    bool curves = false;
    for (int i = 0; i < int(quadrics.size()) && problem_.empty(); ++i) {
      const Quadric& q = quadrics[std::size_t(i)];
      if (!is_curve_kind(q.kind)) {
        require(in(q.kind, QUADRIC_SPHERE, has(FEATURE_CYLINDERS) ? QUADRIC_CYLINDER : QUADRIC_DISK),
                "a quadric of unknown kind");
        continue;
      }
      curves = true;
      require(has(FEATURE_CURVES) && q.kind <= QUADRIC_CYLINDRICAL_RIBBON, "a quadric of unknown kind");
      require(q.light == -1, "a curve that is a light");
      require(i < int(quadrics.size()) - moving, "a curve that moves");
      const float length = length3(sub(q.x_axis, q.center)), span = length3(q.y_axis);
      require(is_finite3(q.center) && std::isfinite(length) && length > 0.0f && q.radius >= 0.0f &&
                  q.length >= 0.0f && std::isfinite(q.radius) && std::isfinite(q.length),
              "a piece of a curve whose ends are no points, or whose radii are no lengths");
      require(is_finite3(q.normal) && std::isfinite(span) && span > 0.0f && std::isfinite(q.orientation),
              "a piece of a curve whose cuts are no planes");
    }
    // The search without a hierarchy knows no curves.
    require(!curves || has(FEATURE_BVH) || h_.intersector == INTERSECTOR_EMBREE,
            "curves without a hierarchy");
  }

  /// Checks the numbers of photon maps, and the media at lights.
  void check_photons() {
    const IntegratorParameters& p = h_.integrator;
    require(in(p.photons, PHOTONS_NONE, PHOTONS_FIXED) && has(FEATURE_PHOTONS) == (p.photons != PHOTONS_NONE),
            "photon maps and their feature bit go together");
    require(h_.tables.light_media.count ==
                (has(FEATURE_PHOTONS) && has(FEATURE_MEDIA) ? h_.tables.lights.count : 0),
            "the media at lights do not match the lights");
    if (!has(FEATURE_PHOTONS) || !problem_.empty()) return;
    require(p.kind == INTEGRATOR_PATH && h_.tables.lights.count > 0, "photon maps without paths or lights");
    for (const int photons : {p.surface_photons, p.caustic_photons, p.volume_photons})
      require(in(photons, 0, MAX_PHOTONS), "an implausible number of photons");
    for (const float radius : {p.surface_radius, p.caustic_radius, p.volume_radius, p.emission_radius})
      require(radius > 0 && std::isfinite(radius), "photons with a radius that is no length");
    const int other = p.photons == PHOTONS_FIXED ? GATHER_SECOND : GATHER_CAUSTICS;
    require(p.gathering == GATHER_FIRST || p.gathering == other, "photons are gathered in an unknown way");
    require(p.photons == PHOTONS_FIXED || p.caustic_photons == 0, "photons of a map that is not there");
    require(p.radius_alpha > 0 && p.radius_alpha <= 1, "radii of photon maps that do not shrink");
    require(p.samples_per_map > 0 && p.lookup_size > 0, "photon maps without samples or lookups");
    for (const LightMedia& at : table<LightMedia>(scene_, h_.tables.light_media))
      for (const std::uint32_t media : {at.low, at.high})
        for (int shift = 0; shift < 32; shift += 8)
          require(int(media >> shift & 0xffu) < h_.tables.media.count,
                  "a light is in a medium that is not there");
  }

  /// Whether the material has the same index for all channels, or is a dielectric with an index for each.
  [[nodiscard]] bool check_channels(const Material& m) const {
    const vec3 index = m.channel_ior;
    if (index.x == 0.0f && index.y == 0.0f && index.z == 0.0f) return true;
    const auto is_index = [](float x) { return x > 0.0f && std::isfinite(x); };
    return is_index(index.x) && is_index(index.y) && is_index(index.z) && m.branches == 0 &&
           m.flat_glass == 0 && (DISPERSING >> m.family & 1u) != 0u && has(FEATURE_DISPERSION);
  }

  /// Checks that descents in material trees end, at leaves of known kinds.
  void check_material_trees() {
    const auto materials = table<Material>(scene_, h_.tables.materials);
    for (int i = 0; i < int(materials.size()); ++i) {
      const Material& m = materials[std::size_t(i)];
      require(m.branches == 0 || (i > 0 && m.first < i && m.second < i),
              i > 0 ? "a material holds one that does not come before it"
                    : "the first material, where walks end, holds others");
      require(in(m.branches, 0, 1) && in(m.passes, PASSES_NONE, PASSES_SOME), "a material of unknown kind");
      const auto leaves_of = [&](int child) {
        return std::int64_t{child < 0 ? 1 : child < i ? materials[std::size_t(child)].passing_leaves : 0};
      };
      require(in(m.passing_leaves, 0, MOST_PASSING_LEAVES) &&
                  m.passing_leaves == (m.branches == 0 ? int(m.passes != PASSES_NONE)
                                                       : leaves_of(m.first) + leaves_of(m.second)),
              "a material with a wrong number of leaves that let rays pass");
      require(m.weight >= 0.0f && m.weight <= 1.0f, "a material's weight is not in [0, 1]");
      require(in(m.bend, BEND_NONE, BEND_BUMP_MAP) && in(m.coat_bend, BEND_NONE, BEND_BUMP_MAP),
              "a normal is bent in an unknown way");
      require(in(m.turn, -1, 1) && std::isfinite(m.turn_cosine) && std::isfinite(m.turn_sine),
              "a tangent is turned in an unknown way");
      require(m.pane == 0.0f || (m.pane > 0.0f && std::isfinite(m.pane) && has(FEATURE_PANES) &&
                                 m.branches == 0 && m.passes == PASSES_SOME),
              "a thin pane that is none");
      require(m.flat_glass == 0 || (m.flat_glass == 1 && m.family == FAMILY_DIELECTRIC && m.branches == 0 &&
                                    m.bend == BEND_NONE && m.transmitted_texture == -1 &&
                                    has(FEATURE_FLAT_GLASS) && has(FEATURE_PATH) && !has(FEATURE_MEDIA)),
              "flat glass that is none");
      require(check_channels(m), "a dispersing dielectric that is none");
      require(has(FEATURE_NESTED) || (m.branches == 0 && m.passes == PASSES_NONE),
              "materials that hold others without their feature bit");
      require(m.bend == BEND_NONE || (has(FEATURE_BENT) && has(FEATURE_TEXTURES) && has(FEATURE_UV)),
              "bent normals without their feature bits");
      require(m.coat_bend == BEND_NONE || (has(FEATURE_COAT_NORMALS) && has(FEATURE_TEXTURES)),
              "normals of a coat without their feature bits");
      require(!has_own_coat(m) || (has(FEATURE_COAT_NORMALS) && has(FEATURE_BENT) && has(FEATURE_UV)),
              "a coat's own normal without its feature bits");
    }
  }

  void check_textures() {
    int colours = 0;  // largest number per triangle
    const auto textures = table<TextureNode>(scene_, h_.tables.textures);
    for (std::size_t i = 0; i < textures.size(); ++i) {
      const TextureNode& t = textures[i];
      // So chains of textures end.
      require(t.texture0 < int(i) && t.texture1 < int(i), "a texture holds one that does not come before it");
      check_texture(t);
      if (t.kind == TEXTURE_MESH_ATTRIBUTE) {
        require(in(t.attribute, 0, 31), "a texture shows an implausible attribute of meshes");
        colours = std::max(colours, t.attribute + 1);
      }
    }
    const int triangles = h_.tables.triangle_colours.count;
    require(triangles == 0 || triangles == h_.tables.triangles.count, "colours do not match the triangles");
    for (const int first : table<int>(scene_, h_.tables.triangle_colours))
      require(first == -1 || in(first, 0, h_.tables.vertex_colours.count - colours),
              "a triangle has colours that are not there");
  }

  void check_texture(const TextureNode& t) {
    require(in(t.kind, 0, TEXTURE_KIND_COUNT - 1) && holds(h_.texture_kinds, t.kind),
            "a texture of a kind that the header does not name");
    if (!in(t.kind, TEXTURE_BYTE_BITMAP, TEXTURE_FLOAT_BITMAP)) return;
    require(t.width > 0 && t.height > 0 && (t.channels == 1 || t.channels == 3) &&
                in(t.wrap_u, WRAP_REPEAT, WRAP_ONE) && in(t.wrap_v, WRAP_REPEAT, WRAP_ONE),
            "a bitmap of implausible size, channels or edges");
    const bool bytes = t.kind == TEXTURE_BYTE_BITMAP, shorts = t.kind == TEXTURE_SHORT_BITMAP;
    const std::uint64_t values = std::uint64_t(t.width) * std::uint64_t(t.height) * std::uint64_t(t.channels);
    const int size = bytes ? 1 : t.kind == TEXTURE_FLOAT_BITMAP ? 4 : 2, words = h_.tables.texels.count;
    // Kernels number values with 32 bits, and may read one word beyond the last texel.
    require(values < std::uint64_t{1} << 32 && t.texels >= 0 &&
                std::uint64_t(t.texels) + (values * std::uint64_t(size) + 3) / 4 < std::uint64_t(words),
            "a bitmap's texels are not there");
    const int decoded = bytes    ? 256
                        : shorts ? 65536
                                 : INT_MAX;  // values in the table, which 8-bit bitmaps must have
    require((t.decoding == -1 && !bytes) || in(t.decoding, 0, words - decoded),
            "a bitmap's table of values is not there");
  }

  void check_uvs() {
    const int uvs = h_.tables.vertex_uvs.count, parts = h_.tables.light_triangles.count;
    require(has(FEATURE_UV) || (uvs == 0 && parts == 0), "texture coordinates without their feature bit");
    require(!has(FEATURE_LIGHT_TEXTURES) || (has(FEATURE_TEXTURES) && has(FEATURE_UV)),
            "lights with textures without the feature bits of textures");
    const int tangents = h_.tables.vertex_tangents.count;
    require(tangents == (has(FEATURE_TANGENTS) ? h_.tables.triangles.count : 0) &&
                (tangents == 0 || has(FEATURE_UV)),
            "tangents do not match the triangles or their feature bits");
    require(uvs == 0 || uvs == h_.tables.triangles.count, "texture coordinates do not match the triangles");
    require(parts == 0 || parts == h_.tables.lights.count, "triangles of lights do not match the lights");
  }

  void check_instances() {
    const auto groups = table<PrimitiveGroup>(scene_, h_.tables.groups);
    const bool some = h_.tables.instances.count > 0;
    require(some == has(FEATURE_INSTANCES), "instances and their feature bit go together");
    require(some == !groups.empty(), "instances without groups, or groups without instances");
    require(!some || has(FEATURE_BVH) || h_.intersector == INTERSECTOR_EMBREE,
            "instances without a hierarchy");
    for (const Instance& i : table<Instance>(scene_, h_.tables.instances))
      require(i.group > 0, "an instance names the scene itself");
    for (const PrimitiveGroup& g : groups) {
      require(in(g.first_triangle, 0, h_.tables.triangles.count) &&
                  in(g.triangle_count, 0, h_.tables.triangles.count - g.first_triangle),
              "a group names triangles that are not there");
      require(in(g.first_quadric, 0, h_.tables.quadrics.count) &&
                  in(g.quadric_count, 0, h_.tables.quadrics.count - g.first_quadric),
              "a group names quadrics that are not there");
    }
  }

  /// Checks that every primitive has a valid matte.
  void check_mattes() {
    const TableSpans& t = h_.tables;
    if (!has(FEATURE_MATTES)) {
      require(t.mattes.count == 0 && t.instance_mattes.count == 0 && h_.matte_count == 0,
              "mattes without their feature bit");
      return;
    }
    require(in(h_.matte_count, 0, MAX_MATTES), "an implausible number of mattes");
    require(t.mattes.count == std::int64_t{t.triangles.count} + t.quadrics.count,
            "mattes do not match the primitives");
    require(t.instance_mattes.count == t.instances.count, "mattes do not match the instances");
    if (!problem_.empty()) return;
    const auto mattes = table<int>(scene_, t.mattes), firsts = table<int>(scene_, t.instance_mattes);
    const auto groups = table<PrimitiveGroup>(scene_, t.groups);
    // The range of what the instances of each group add.
    std::vector<std::pair<int, int>> added(std::max<std::size_t>(groups.size(), 1),
                                           {std::numeric_limits<int>::max(), 0});
    added[0] = {0, 0};  // shapes that are not instanced
    const auto instances = table<Instance>(scene_, t.instances);
    for (std::size_t i = 0; i < instances.size(); ++i) {
      auto& [least, most] = added[std::size_t(instances[i].group)];
      least = std::min(least, firsts[i]);
      most = std::max(most, firsts[i]);
    }
    const auto check = [&](int first, int count, std::pair<int, int> range) {
      for (const int matte : mattes.subspan(std::size_t(first), std::size_t(count)))
        require(matte >= 0 && std::int64_t{matte} + range.first >= 1 &&
                    std::int64_t{matte} + range.second <= h_.matte_count,
                "a primitive names a matte that is not there");
    };
    if (groups.empty()) check(0, t.mattes.count, added[0]);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      check(groups[g].first_triangle, groups[g].triangle_count, added[g]);
      check(t.triangles.count + groups[g].first_quadric, groups[g].quadric_count, added[g]);
    }
  }

  /// Checks what layers on demand read.
  void check_layers() {
    const TableSpans& t = h_.tables;
    require(is_finite3(h_.center), "a centre that is nowhere");
    require(has(FEATURE_UV) || !has(FEATURE_UV_LAYER), "a layer of texture coordinates without coordinates");
    require(!has(FEATURE_DIRECT_LAYER | FEATURE_INDIRECT_LAYER) ||
                (h_.integrator.kind == INTEGRATOR_PATH && !has(FEATURE_PHOTONS) &&
                 h_.integrator.estimator == ESTIMATOR_SAMPLES),
            "an integrator that cannot tell direct from indirect light");
    const bool shapes = has(FEATURE_SHAPE_LAYER);
    require(t.primitive_shapes.count == (shapes ? std::int64_t{t.triangles.count} + t.quadrics.count : 0),
            "shapes do not match the primitives");
    require(in(h_.shape_count, 0, shapes ? MAX_SHAPES : 0), "an implausible number of shapes");
    if (!problem_.empty()) return;
    for (const int shape : table<int>(scene_, t.primitive_shapes))
      require(in(shape, 1, h_.shape_count), "a primitive names a shape that is not there");
  }

  /// Checks the states of what moves, and the hierarchy over it.
  void check_motion() {
    const TableSpans& t = h_.tables;
    const bool some = t.shutter.count + t.shutter_curve.count + t.camera_states.count +
                          t.triangle_motions.count + t.triangle_states.count + t.quadric_motions.count +
                          t.quadric_states.count + t.instance_motions.count + t.instance_states.count +
                          t.light_motions.count + t.light_states.count + t.motion_nodes.count +
                          t.motion_leaves.count >
                      0;
    require(has(FEATURE_MOTION) ? t.shutter.count == 1 : !some && h_.camera_moves == 0,
            "motion and its feature bit go together");
    require(!has(FEATURE_MOTION) || !has(FEATURE_LIGHT_EDGES), "edges of lights where something moves");
    if (!has(FEATURE_MOTION) || !problem_.empty()) return;
    const Shutter& s = table<Shutter>(scene_, t.shutter)[0];
    check_curve(s);
    require(s.still_triangles == t.triangles.count - t.triangle_motions.count && s.still_triangles >= 0,
            "triangles that move do not match the triangles");
    require(s.still_quadrics == t.quadrics.count - t.quadric_motions.count && s.still_quadrics >= 0,
            "quadrics that move do not match the quadrics");
    require(s.still_instances == t.instances.count - t.instance_motions.count && s.still_instances >= 0,
            "instances that move do not match the instances");
    require(t.light_motions.count == 0 || t.light_motions.count == t.lights.count,
            "lights that may move do not match the lights");
    require(in(s.camera_steps, 0, MOST_MOTION_STEPS) &&
                t.camera_states.count == (s.camera_steps > 0 ? states_of(s.camera_steps) : 0),
            "the camera's states are not there");
    require(in(h_.camera_moves, 0, t.camera_states.count > 0 ? 1 : 0), "a camera that moves without states");
    check_motions(t.triangle_motions, t.triangle_states, 1);
    check_motions(t.quadric_motions, t.quadric_states, 1);
    check_motions(t.instance_motions, t.instance_states, 1);
    check_motions(t.light_motions, t.light_states, 0);
    if (problem_.empty()) check_motion_tree(s);
  }

  void check_curve(const Shutter& s) {
    const auto share = [](float value) { return value >= 0 && value <= 1; };
    require(share(s.exposure) && share(s.rolling), "a row is exposed outside of the shutter's time");
    require(s.curve_knots >= 2 && h_.tables.shutter_curve.count == std::int64_t{2} * s.curve_knots,
            "a shutter's curve without its knots");
    if (!problem_.empty()) return;
    const auto curve = table<float>(scene_, h_.tables.shutter_curve);
    const auto knots = std::size_t(s.curve_knots);
    for (std::size_t k = 0; k < knots; ++k)
      require(curve[k] >= 0 && std::isfinite(curve[k]) && share(curve[knots + k]) &&
                  (k == 0 || curve[knots + k] >= curve[knots + k - 1]),
              "a shutter's curve of implausible numbers");
  }

  [[nodiscard]] int states_of(int steps) const { return steps + 1 + (has(FEATURE_MOTION_LAYER) ? 2 : 0); }

  void check_motions(TableSpan motions, TableSpan states, int fewest_steps) {
    for (const Motion& m : table<Motion>(scene_, motions)) {
      require(in(m.steps, fewest_steps, MOST_MOTION_STEPS),
              "something moves in an implausible number of steps");
      if (m.steps == 0 || !problem_.empty()) continue;
      const std::int64_t last = m.first + std::int64_t{m.stride} * (states_of(m.steps) - 1);
      require(m.first >= 0 && m.stride >= 1 && last < states.count,
              "something moves to a state that is not there");
    }
  }

  /// Empty slots of nodes name any leaf.
  void check_motion_leaf(int at) {
    const auto leaves = table<MotionLeaf>(scene_, h_.tables.motion_leaves);
    const MotionLeaf& leaf = leaves[std::size_t(at)];
    require(in(leaf.steps, 1, MOST_MOTION_STEPS) && in(leaf.first_step, 0, leaf.last_step) &&
                leaf.last_step <= leaf.steps &&
                at + std::int64_t{leaf.last_step} - leaf.first_step < h_.tables.motion_leaves.count,
            "a leaf of what moves has states that are not there");
    require(leaf.instance[0] >= 0 || leaf.last_step > leaf.first_step,
            "a leaf of what moves has fewer than two states");
  }

  /// Children come after their only parent, so that every traversal ends.
  void check_motion_tree(const Shutter& s) {
    const TableSpans& t = h_.tables;
    const bool some = t.triangle_motions.count + t.quadric_motions.count + t.instance_motions.count > 0;
    require(some == (t.motion_nodes.count > 0), "a hierarchy of what moves where nothing does, or none");
    const auto nodes = table<MotionNode>(scene_, t.motion_nodes);
    std::vector<int> depth(nodes.size(), 0);
    if (!nodes.empty()) depth[0] = 1;
    for (std::size_t i = 0; i < nodes.size() && problem_.empty(); ++i) {
      require(depth[i] > 0, "a node of what moves has no parent");
      require(depth[i] <= BVH_MAX_DEPTH, "the hierarchy of what moves is too deep");
      for (int k = 0; k < BVH_WIDTH && problem_.empty(); ++k) {
        const int child = nodes[i].child[k];
        if (child < 0) {
          require(~child < t.motion_leaves.count, "a node of what moves names a leaf that is not there");
          if (problem_.empty()) check_motion_leaf(~child);
          continue;
        }
        require(child > int(i) && child < t.motion_nodes.count,
                "a node of what moves names a child that is not there");
        if (!problem_.empty()) return;
        require(depth[std::size_t(child)] == 0, "a node of what moves has two parents");
        depth[std::size_t(child)] = depth[i] + 1;
      }
    }
    const auto moves = [&](int primitive) {
      return in(primitive, s.still_triangles, t.triangles.count - 1) ||
             (primitive >= t.triangles.count && primitive - t.triangles.count >= s.still_quadrics &&
              primitive - t.triangles.count < t.quadrics.count);
    };
    for (const MotionLeaf& leaf : table<MotionLeaf>(scene_, t.motion_leaves))
      for (int k = 0; k < BVH_WIDTH; ++k) {
        require(leaf.primitive[k] == -1 || moves(leaf.primitive[k]),
                "a leaf of what moves names a primitive that does not");
        require(leaf.instance[k] == -1 || in(leaf.instance[k], s.still_instances, t.instances.count - 1),
                "a leaf of what moves names an instance that does not");
      }
    require(t.instance_motions.count == 0 || t.nodes.count > 0,
            "instances that move without the trees of groups");
  }

  /// Checks the tables that the environment map reads, see envmap_light.h.
  void check_envmap() {
    const TableSpans& t = h_.tables;
    require(t.envmaps.count == 1, "an environment map is not there");
    if (!problem_.empty()) return;
    const EnvironmentMap map = table<EnvironmentMap>(scene_, t.envmaps)[0];
    constexpr int kMostTexels = 1 << 15;  // along one side
    const bool sized = in(map.width, 2, kMostTexels) && in(map.height, 2, kMostTexels);
    const std::int64_t texels = std::int64_t{map.width} * map.height;
    require(map.covered >= 0 && std::isfinite(map.covered), "an environment map's mean is out of range");
    require(sized && t.envmap_texels.count == texels &&
                t.envmap_rows.count == envmap_shares(map.height) + search_size(map.height) &&
                t.envmap_columns.count == std::int64_t{search_size(map.width + 1)} * map.height,
            "an environment map's tables do not match its size");
  }

  void check_beam(const Light& l) {
    require(!is_beam_light(l.kind) || h_.tables.lights.count == 0 || in(l.beam, 0, h_.tables.beams.count - 1),
            "a light's beam is not there");
    require(l.kind != LIGHT_MEDIUM || h_.tables.lights.count == 0 ||
                (has(FEATURE_EMITTING_MEDIA) && in(l.beam, 0, h_.tables.glows.count - 1) && l.area > 0),
            "the medium of a light is not there");
  }

  /// Checks the light's texture and its grid, see light_grid.h.
  void check_light_texture(const Light& l) {
    if (h_.tables.lights.count == 0) return;
    require(l.texture < 0 || has(FEATURE_LIGHT_TEXTURES), "a light's texture without its feature bit");
    if (l.grid == -1) return;
    require(has(FEATURE_LIGHT_TEXTURES), "a light's distribution without its feature bit");
    const bool sized = in(l.grid_side, 1, MOST_LIGHT_GRID_SIDE);
    const std::int64_t corners = std::int64_t{l.grid_side} + 1, numbers = corners * corners;
    require(sized && l.grid >= 0 && l.grid + numbers <= h_.tables.light_grids.count,
            "a light's distribution is not there");
    require(l.sampling == EMITTER_AREA &&
                (l.kind == LIGHT_TRIANGLE || l.kind == LIGHT_SPHERE || l.kind == LIGHT_DISK),
            "a distribution over a light that is not sampled by area");
  }

  void check_polygons() {
    for (const Polygon& p : table<Polygon>(scene_, h_.tables.polygons)) {
      require(in(p.first_light, 0, h_.tables.lights.count - 1) &&
                  in(p.light_count, 1, h_.tables.lights.count - p.first_light),
              "a polygon names lights that are not there");
      require(in(p.first_corner, 0, h_.tables.polygon_corners.count - 1) &&
                  in(p.corner_count, 1, h_.tables.polygon_corners.count - p.first_corner),
              "a polygon names corners that are not there");
      if (!problem_.empty()) return;
      require(
          table<PolygonCorner>(scene_, h_.tables.polygon_corners)[std::size_t(p.first_corner)].starts == 1,
          "a polygon starts within a loop");
    }
  }

  /// Checks that every number of a sampler selects a cell.
  void check_light_cells() {
    const int count = h_.tables.light_cells.count;
    require(count == 0 || (count <= int(LIGHT_PROBABILITY_STEPS) && (count & (count - 1)) == 0),
            "cells of the choice of lights that are no power of two");
    require(count > 0 || h_.tables.lights.count <= 1, "no cells to choose lights by");
    for (const int light : table<int>(scene_, at_least_one(h_.tables.light_cells)))
      require(in(light, 0, std::max(h_.tables.lights.count, int(LEAST_lights)) - 1),
              "a cell of the choice of lights names one that is not there");
  }

  void check_light_edges() {
    const auto rows = table<int>(scene_, h_.tables.light_edge_rows);
    require(h_.tables.light_edge_rows.count == std::int64_t{h_.film.height} + 1,
            "rows of edges of lights do not match the film");
    if (!problem_.empty()) return;
    require(
        rows.front() == 0 && rows.back() == h_.tables.light_edge_pixels.count && std::ranges::is_sorted(rows),
        "rows of edges of lights are not in order");
    for (const LightEdgePixel& pixel : table<LightEdgePixel>(scene_, h_.tables.light_edge_pixels))
      require(
          pixel.edge_count >= 0 && in(pixel.first_edge, 0, h_.tables.light_edges.count - pixel.edge_count),
          "a pixel names edges of lights that are not there");
  }

  /// Checks that every descent ends at a light.
  void check_light_tree() {
    require(in(h_.light_cut, 1, LIGHT_CUT) && h_.light_cut <= h_.tables.light_nodes.count,
            "a hierarchy of lights without a root");
    require(h_.tables.light_trails.count == h_.tables.lights.count, "ways to lights do not match the lights");
    require(in(h_.light_tree_depth, 0, 28), "the hierarchy of lights is too deep");
    require(h_.light_leaf_steps == 0 || (in(h_.light_leaf_steps, 1, 20) && h_.tables.light_members.count > 0),
            "lights of leaves that no search finds");
    require(h_.light_leaf_steps == 0 || h_.tables.light_numbers.count == h_.tables.lights.count,
            "shares of lights do not match the lights");
    const auto nodes = table<LightNode>(scene_, h_.tables.light_nodes);
    std::vector<int> depth(nodes.size(), -1);
    for (std::size_t k = 0; k < nodes.size() && int(k) < h_.light_cut; ++k) depth[k] = 0;
    for (std::size_t i = 0; i < nodes.size() && problem_.empty(); ++i) {
      const LightNode& node = nodes[i];
      require(depth[i] >= 0, "a node of lights has no parent");
      require(depth[i] <= h_.light_tree_depth, "a node of lights is deeper than its hierarchy");
      require(in(node.flags, 0, LIGHTS_TWO_SIDED | LIGHTS_INFINITE), "a node of lights of unknown kind");
      const float largest = std::numeric_limits<float>::max();
      require(node.intensity >= 0.0f && node.intensity <= largest, "a node of lights without an intensity");
      if (node.child < 0) {
        if (node.lights > 1)
          check_light_leaf(~node.child, node.lights);
        else
          require(~node.child < h_.tables.lights.count, "a node names a light that is not there");
        continue;
      }
      require(node.child > int(i) && node.child < h_.tables.light_nodes.count - 1,
              "a node of lights names a child that is not there");
      if (!problem_.empty()) return;
      for (const int child : {node.child, node.child + 1}) {
        require(depth[std::size_t(child)] < 0, "a node of lights has two parents");
        depth[std::size_t(child)] = depth[i] + 1;
      }
    }
  }

  /// Checks that every number selects a light in a leaf that has several.
  void check_light_leaf(int first, int count) {
    const auto members = table<LightMember>(scene_, h_.tables.light_members);
    const auto numbers = table<int>(scene_, h_.tables.light_numbers);
    require(h_.light_leaf_steps > 0, "lights of leaves that no search finds");
    require(first <= int(members.size()) - count, "a leaf of lights names lights that are not there");
    if (!problem_.empty()) return;
    require(count <= 1 << h_.light_leaf_steps, "a leaf of lights has more than a search finds");
    for (int k = 0; k < count && problem_.empty(); ++k) {
      const LightMember& member = members[std::size_t(first + k)];
      const int next =
          k + 1 < count ? members[std::size_t(first + k) + 1].start : int(LIGHT_PROBABILITY_STEPS);
      require(in(member.light, 0, h_.tables.lights.count - 1), "a node names a light that is not there");
      require(member.start >= 0 && (k > 0 || member.start == 0) && next <= int(LIGHT_PROBABILITY_STEPS),
              "shares of lights in a leaf are not those of all numbers");
      if (!problem_.empty()) return;
      require(next > member.start && numbers[std::size_t(member.light)] == next - member.start,
              "shares of lights in a leaf are not those of all numbers");
    }
  }

  void check_search() {
    if (has(FEATURE_BVH) || h_.tables.nodes.count > 0) check_hierarchy();
    if (h_.intersector == INTERSECTOR_EMBREE) return;
    if (has(FEATURE_BVH) && h_.tables.corners.count == 0) return;
    require(h_.tables.instances.count == 0, "a scene with instances that is tested whole");
    require(h_.tables.vertices.count <= MAX_WHOLE_VERTICES, "too many vertices to be tested whole");
    const int still = h_.tables.triangles.count - h_.tables.triangle_motions.count;
    require(still <= MAX_WHOLE_TRIANGLES, "too many triangles to be tested whole");
    require(h_.tables.corners.count == still, "corners do not match the triangles");
  }

  void check_hierarchy() {
    const TableSpans& tables = h_.tables;
    std::vector<int> roots;
    for (const PrimitiveGroup& group : table<PrimitiveGroup>(scene_, tables.groups))
      roots.push_back(group.root);
    const std::string problem =
        hierarchy_problem({.nodes = table<BvhNode>(scene_, tables.nodes),
                           .roots = roots,
                           .triangle_leaves = table<TriangleLeaf>(scene_, tables.triangle_leaves),
                           .quadric_leaves = table<QuadricLeaf>(scene_, tables.quadric_leaves),
                           .triangles = tables.triangles.count,
                           .quadrics = tables.quadrics.count,
                           .instances = tables.instances.count});
    if (problem_.empty()) problem_ = problem;
  }
};

}  // namespace

Expected<void> check_device_scene(const DeviceScene& scene) { return Checker(scene).run(); }

}  // namespace penumbra
