#include "scenes/device/device_scene_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <climits>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "kernels/host/device_scene.h"
#include "kernels/host/view.h"
#include "scenes/device/camera_builder.h"
#include "scenes/device/curve_pieces.h"
#include "scenes/device/device_materials.h"
#include "scenes/device/filter_table.h"
#include "scenes/device/flight_centres.h"
#include "scenes/device/hierarchy/motion_tree.h"
#include "scenes/device/integrator_builder.h"
#include "scenes/device/light_builder.h"
#include "scenes/device/light_choice.h"
#include "scenes/device/light_edges.h"
#include "scenes/device/light_media.h"
#include "scenes/device/light_textures.h"
#include "scenes/device/ltc/ltc_table.h"
#include "scenes/device/matte_book.h"
#include "scenes/device/media_book.h"
#include "scenes/device/medium_lights.h"
#include "scenes/device/motion_tables.h"
#include "scenes/device/moving_parts.h"
#include "scenes/device/quadric_record.h"
#include "scenes/device/scene_records.h"
#include "scenes/device/texture_coordinates.h"
#include "scenes/device/texture_tables.h"
#include "scenes/device/to_vec3.h"
#include "scenes/interiors.h"
#include "scenes/scene_bounds.h"
#include "scenes/traceable.h"
#include "scenes/transform.h"

namespace penumbra {
namespace {

static_assert(int(SamplerKind::kSobol) == SAMPLER_SOBOL);

bool finite(const vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::uint64_t feature_of(AskedLayer layer) {
  constexpr std::uint64_t kFeatures[] = {
      FEATURE_POSITION_LAYER, FEATURE_UV_LAYER | FEATURE_UV, FEATURE_GEOMETRIC_NORMAL_LAYER,
      FEATURE_SHAPE_LAYER,    FEATURE_DIRECT_LAYER,          FEATURE_INDIRECT_LAYER,
      FEATURE_MOTION_LAYER};
  return kFeatures[int(layer)];
}

/// Whether camera rays that miss all shapes may still see light.
bool sees_sky(const SceneHeader& h) {
  const IntegratorParameters& p = h.integrator;
  if (p.kind == INTEGRATOR_OCCLUSION) return p.background > 0;
  return h.environment >= 0 && p.hide_emitters <= HIDE_NOTHING;
}

class SceneBuilder {
 public:
  /// `motion`: what moves while the shutter is open; null: an image of one instant.
  SceneBuilder(const SceneDescription& scene, const DeviceSceneOptions& options, const ExposedMotion* motion,
               bool with_hidden_groups)
      : scene_(scene),
        options_(options),
        moving_(moving_parts(scene)),
        with_hidden_groups_(with_hidden_groups),
        lights_(default_sampling(scene.integrator), wants_polygons(scene.integrator)),
        light_textures_(scene, records_, {}) {
    if (auto placed = place_groups(scene))
      placed_ = std::move(*placed);
    else
      problem_ = placed.error().message;
    const auto moves = [this](const PlacedGroup& place) { return bool(moving_.instances[place.instance]); };
    std::vector<PlacedGroup> moving;
    std::ranges::copy_if(placed_, std::back_inserter(moving), moves);
    std::erase_if(placed_, moves);
    still_placed_ = placed_.size();
    placed_.insert(placed_.end(), moving.begin(), moving.end());
    center_ = origin_of(scene, moving_, placed_);
    radius_ = radius_about(center_, scene, moving_, placed_);
    if (motion != nullptr) {
      motion_.emplace(scene, *motion);
      need(FEATURE_MOTION);
      radius_ = std::max(radius_, motion_->radius_about(center_, placed_));
    }
    if (options.mattes != nullptr) mattes_.emplace(scene);
    media_.emplace(scene, placed_);
    lights_.set_textures(light_textures_);
    lights_.set_receivers(light_receivers(scene, center_), scene.integrator);
  }

  Expected<DeviceScene> build() {
    for (const AskedLayer layer : scene_.film.layers) need(feature_of(layer));
    if (has(FEATURE_POSITION_LAYER)) h_.center = to_vec3(center_);
    if (Expected<void> done = add_materials(); !done)
      return fail(scene_.source + ": " + done.error().message);
    lights_.set_default_sampling(default_sampling(scene_.integrator, has_narrow_lobes(records_.materials)));
    reserve_triangles();
    add_all_shapes();
    if (is_short_of_instances_) return DeviceScene();
    add_other_lights();
    if (motion_)
      if (Expected<void> done = motion_->fill(center_, records_, lights_); !done)
        return fail(scene_.source + ": " + done.error().message);
    set_camera();
    if (!problem_.empty()) return fail(scene_.source + ": " + problem_);
    set_film();
    need(lights_.features());
    h_.light_kinds = lights_.kinds();
    if (options_.feature_layers) need(FEATURE_LAYERS);
    if (scene_.film.denoise != Denoise::kOff) need(FEATURE_DENOISING);
    if (scene_.film.alpha) need(FEATURE_COVERAGE);
    if (wants_uv()) {
      need(FEATURE_UV);
      records_.light_triangles =
          light_triangles(records_.triangles, records_.quadrics, records_.lights.size());
    }
    hide_unseen(records_.triangles);
    hide_unseen(records_.quadrics);
    if (Expected<void> done = set_integrator(scene_.integrator, lights_, radius_, h_); !done)
      return fail(scene_.source + ": " + done.error().message);
    if (Expected<void> done = check_split_light(scene_.integrator, h_); !done)
      return fail(scene_.source + ": " + done.error().message);
    h_.film.sky_coverage = scene_.film.alpha && sees_sky(h_) ? 1.0f : 0.0f;
    if ((h_.features & (FEATURE_POLYGONS | FEATURE_PROJECTED)) != 0u &&
        (h_.families & ltc_families()) != 0u) {
      need(FEATURE_LTC);
      records_.ltc_cells = ltc_table();
    }
    if (scene_.sampler.kind != SamplerKind::kSobol) need(FEATURE_SAMPLERS);
    if (Expected<void> done = add_intersector(options_.intersector, hierarchies_, h_, records_); !done)
      return std::unexpected(done.error());
    if (motion_) add_motion_tree(records_, 2 * radius_);
    records_.primitive_boundaries.insert(records_.primitive_boundaries.end(), quadric_boundaries_.begin(),
                                         quadric_boundaries_.end());
    if ((h_.features & FEATURE_PHOTONS) != 0u && (h_.features & FEATURE_MEDIA) != 0u)
      records_.light_media = light_media(h_, records_);
    if (mattes_)
      if (Expected<void> done = store_mattes(); !done) return std::unexpected(done.error());
    if (has(FEATURE_SHAPE_LAYER))
      if (Expected<void> done = store_shapes(); !done) return std::unexpected(done.error());
    if (media_->has_homogeneous()) records_.flight_centres = flight_centres(lights_.bounds());
    records_.filter_table = filter_table(scene_.film);
    if (Expected<void> done = trace_pilot_rays(); !done) return std::unexpected(done.error());
    if (!records_.nodes.empty()) out_.still = hierarchies_.built();
    store(std::move(records_), out_);
    if (out_.words.size() > std::size_t(INT_MAX))
      return fail(scene_.source + ": the scene exceeds 8 GiB of tables");
    return std::move(out_);
  }

  /// Whether the scene must be built again without hidden groups.
  [[nodiscard]] bool is_short_of_instances() const { return is_short_of_instances_; }

 private:
  void need(std::uint64_t feature) { h_.features |= feature; }
  [[nodiscard]] bool has(std::uint64_t feature) const { return (h_.features & feature) != 0u; }
  [[nodiscard]] bool wants_uv() const { return options_.surface_uv || (h_.features & FEATURE_UV) != 0u; }

  /// Position relative to the scene's centre. `reach`: the shape's extent around the position. `what` returns
  /// what it belongs to, for an error.
  template <typename What>
  vec3 local(const glm::dvec3& p, const What& what, double reach = 0) {
    const vec3 v = to_vec3(p - (in_group_ ? *in_group_ : center_));
    if (!(finite(v) && std::isfinite(float(reach))) && problem_.empty())
      problem_ = std::string(what()) + " has a position or a size that is too large for single precision";
    return v;
  }
  vec3 local(const glm::dvec3& p, const Shape& shape, double reach = 0) {
    return local(
        p, [&] { return "shape '" + shape.name + "'"; }, reach);
  }

  [[nodiscard]] bool follows_paths() const {
    return scene_.integrator.is<PathIntegrator>() || scene_.integrator.is<VolpathIntegrator>();
  }

  Expected<void> add_materials() {
    records_.materials.push_back(material_of_family(FAMILY_BLACK));  // 0
    const std::vector<int> of_lights = textures_of_lights(scene_);
    bool textures = std::ranges::any_of(of_lights, [](int t) { return t != kNoTexture; });
    MaterialTables tables(records_.curves);
    // Other integrators meet panes as they meet other glass, except in media.
    const bool opens = follows_paths() || !media_->empty();
    for (std::size_t i = 0; i < scene_.bsdfs.size(); ++i) {
      const Bsdf& bsdf = scene_.bsdfs[i];
      Material m = material_of(bsdf, tables);
      if (media_->sees_interiors()) set_interior(bsdf, m);
      if (opens && open_pane(m)) need(FEATURE_PANES);
      set_passes(m, records_.materials);
      if (m.passing_leaves > MOST_PASSING_LEAVES)
        return fail(
            fmt::format("{}: rays may pass more than {} BSDFs within it", bsdf.name, MOST_PASSING_LEAVES));
      if (m.branches == 0 && m.passes != PASSES_ALL) h_.families |= std::uint64_t{1} << m.family;
      if (m.branches != 0 || m.passes != PASSES_NONE) need(FEATURE_NESTED);
      uses_tangents_ = uses_tangents_ || m.bend == BEND_NORMAL_MAP || m.coat_bend == BEND_NORMAL_MAP ||
                       is_anisotropic(closure_of(m));
      if (m.bend != BEND_NONE) {
        need(FEATURE_BENT);
        m.bend_step = bend_step(scene_, m.bend_texture);
      }
      if (has_own_coat(m)) need(FEATURE_COAT_NORMALS | FEATURE_BENT | FEATURE_UV);
      if (m.coat_bend != BEND_NONE) m.coat_bend_step = bend_step(scene_, m.coat_bend_texture);
      if (is_anisotropic(closure_of(m))) need(m.turn != 0 ? FEATURE_UV | FEATURE_BENT : FEATURE_UV);
      if (disperses(m)) need(FEATURE_DISPERSION);
      h_.textured |= textured_fields(m);
      textures = textures || m.weight_texture != kNoTexture || m.bend_texture != kNoTexture ||
                 m.coat_bend_texture != kNoTexture || m.turn_texture != kNoTexture;
      records_.materials.push_back(m);
    }
    tables.compute();
    if (textures || h_.textured != 0u) add_textures(of_lights);
    if ((h_.families & families_with(TRANSMITS)) != 0u) need(FEATURE_TRANSMISSION);
    if (!media_->empty()) {
      if (Expected<void> done = media_->fill(center_, records_); !done) return done;
      h_.families |= ONLY(PHASE);
      h_.camera_medium = media_->record_of(scene_.camera_medium);
      need(FEATURE_MEDIA | FEATURE_NESTED);
      if (media_->has_interiors()) need(FEATURE_INTERIORS);
      for (const Medium& m : records_.media)
        if (m.exit >= 0) h_.families |= std::uint64_t{1} << records_.materials[std::size_t(m.exit)].family;
      if (std::ranges::any_of(records_.media, [](const Medium& m) { return max_component(m.emission) > 0; }))
        need(FEATURE_EMITTING_MEDIA);
    }
    if (std::popcount(h_.families) > 1) need(FEATURE_MIXED_FAMILIES);
    return {};
  }

  void add_textures(const std::vector<int>& of_lights) {
    std::span<const std::uint32_t> earlier;
    if (options_.earlier != nullptr)
      earlier = table<std::uint32_t>(*options_.earlier, options_.earlier->header.tables.texels);
    TextureTables tables = texture_tables(scene_, records_.materials, of_lights, earlier);
    if (tables.earlier_texels) records_.earlier_texels = earlier;
    for (const TextureNode& texture : tables.textures) h_.texture_kinds |= 1u << texture.kind;
    records_.textures = std::move(tables.textures);
    records_.texels = std::move(tables.texels);
    attributes_ = std::move(tables.attributes);
    light_textures_ = LightTextures(scene_, records_, std::move(tables.places));
    need(FEATURE_TEXTURES | FEATURE_UV);
  }

  /// Reserves room for the triangles of all shapes, each counted once, so that the tables of the largest
  /// scenes are never moved.
  void reserve_triangles() {
    std::size_t triangles = 0, smooth = 0;
    const auto count = [&](const std::vector<Shape>& shapes) {
      for (const Shape& shape : shapes)
        if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
          triangles += mesh->triangles.size();
          smooth += mesh->normals.empty() ? 0 : mesh->triangles.size();
          if (uses_tangents_ && !mesh->tangents.empty()) need(FEATURE_TANGENTS);
        }
    };
    count(scene_.shapes);
    for (const ShapeGroup& group : scene_.groups) count(group.shapes);
    records_.triangles.reserve(triangles);
    records_.normals.reserve(smooth);
    if (wants_uv()) records_.vertex_uvs.reserve(triangles);
    if (has(FEATURE_TANGENTS)) records_.vertex_tangents.reserve(triangles);
    if (!attributes_.empty()) records_.triangle_colours.reserve(triangles);
  }

  void add_shape(const Shape& shape) {
    // Materials of the geometric front and back. With flipped normals they are exchanged.
    const int front = material_index(shape.front_bsdf), back = material_index(shape.back_bsdf);
    if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) add_mesh(shape, *mesh, front, back);
    const auto place = [&](const glm::dvec3& p, double reach) { return local(p, shape, reach); };
    if (const auto quadric = quadric_record(shape, place)) add_quadric(shape, *quadric, front, back);
    if (const auto* curves = std::get_if<Curves>(&shape.geometry)) {
      need(FEATURE_CURVES);
      for (const Quadric& piece : curve_pieces(*curves, place))
        shape.flip_normals ? add_quadric(shape, piece, back, front) : add_quadric(shape, piece, front, back);
    }
  }

  /// Takes unseen lights from the primitives, so that rays find none there.
  template <typename Primitives>
  void hide_unseen(Primitives& primitives) const {
    for (auto& each : primitives)
      if (each.light >= 0 && records_.lights[std::size_t(each.light)].unseen == UNSEEN_BY_RAYS)
        each.light = -1;
  }

  void add_mesh(const Shape& shape, const Mesh& mesh, int front, int back) {
    const std::size_t first = records_.triangles.size();
    for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
      glm::uvec3 corner = mesh.triangles[index];
      if (shape.flip_normals) std::swap(corner.y, corner.z);
      Triangle t{};
      t.p0 = local(mesh.positions[corner.x], shape);
      t.p1 = local(mesh.positions[corner.y], shape);
      t.p2 = local(mesh.positions[corner.z], shape);
      t.front = front;
      t.back = back;
      t.light = -1;
      t.normals = -1;
      const vec3 cross = cross3(sub(t.p1, t.p0), sub(t.p2, t.p0));
      const double area =
          0.5 * std::sqrt(double(cross.x) * cross.x + double(cross.y) * cross.y + double(cross.z) * cross.z);
      if (!(area > 0)) {
        ++h_.dropped_triangles;
        continue;
      }
      if (!mesh.normals.empty()) {
        const float sign = shape.flip_normals ? -1.0f : 1.0f;
        t.normals = int(records_.normals.size());
        records_.normals.push_back({to_vec3(sign * mesh.normals[corner.x]),
                                    to_vec3(sign * mesh.normals[corner.y]),
                                    to_vec3(sign * mesh.normals[corner.z])});
        need(FEATURE_SHADING_NORMALS);
      }
      records_.triangles.push_back(t);
      if (motion_ && motion_->in_shape()) motion_->add_corners(corner);
      if (mattes_) records_.mattes.push_back(matte_);
      if (has(FEATURE_SHAPE_LAYER)) records_.primitive_shapes.push_back(shape_);
      if (!media_->empty()) records_.primitive_boundaries.push_back(boundary_);
      add_colours(mesh, corner, index);
      if (has(FEATURE_TANGENTS))
        records_.vertex_tangents.push_back(
            vertex_tangents(mesh, index, t, shape.mirrors_maps, shape.flip_normals));
      if (wants_uv()) records_.vertex_uvs.push_back(vertex_uvs(mesh, corner, shape.flip_normals));
    }
    if (emits(shape)) add_mesh_lights(shape, first);
  }

  /// Adds lights for the shape's triangles, which start at `first`.
  void add_mesh_lights(const Shape& shape, std::size_t first) {
    std::vector<LightTriangle> emitters;
    for (std::size_t i = first; i < records_.triangles.size(); ++i)
      emitters.push_back({records_.triangles[i].p0, records_.triangles[i].p1, records_.triangles[i].p2});
    const std::vector<int> index =
        lights_.add_triangles(emitters, shape, int(first), motion_ && motion_->in_shape());
    for (std::size_t i = first; i < records_.triangles.size(); ++i)
      records_.triangles[i].light = index[i - first];
  }

  /// Adds the colours of a triangle of the mesh if a texture shows mesh attributes.
  void add_colours(const Mesh& mesh, const glm::uvec3& corner, std::size_t triangle) {
    if (attributes_.empty()) return;
    if (mesh.colours.empty() && mesh.face_colours.empty()) {
      records_.triangle_colours.push_back(-1);
      return;
    }
    records_.triangle_colours.push_back(int(records_.vertex_colours.size()));
    for (const MeshAttribute attribute : attributes_)
      records_.vertex_colours.push_back(triangle_colours(mesh, attribute, corner, triangle));
  }

  /// Adds the scene's shapes, and each group's shapes once, except emitting ones. Those are copied for every
  /// instance, because each copy is a light of its own. If something moves, what is still comes first: the
  /// groups whose shapes are still, then still shapes and emitters.
  void add_all_shapes() {
    if (mattes_)
      for (std::size_t i = 0; i < scene_.shapes.size(); ++i) shape_mattes_.push_back(mattes_->of_shape(i));
    records_.groups.emplace_back();
    group_index_.assign(scene_.groups.size(), -1);
    group_bounds_.resize(scene_.groups.size());
    const bool split = moving_.any();
    if (split) add_groups(groups_in_order(false));
    StillRecords still{.groups = int(records_.groups.size())};
    PrimitiveGroup own{};
    own.first_triangle = int(records_.triangles.size());
    own.first_quadric = int(records_.quadrics.size());
    add_own_shapes(false);
    const std::vector<Shape> emitters = emitters_of_instances();
    const std::size_t next = add_emitters(std::span(placed_).first(still_placed_), emitters, 0);
    still.triangles = int(records_.triangles.size());
    still.quadrics = int(records_.quadrics.size());
    add_own_shapes(true);
    add_emitters(std::span(placed_).subspan(still_placed_), emitters, next);
    own.triangle_count = int(records_.triangles.size()) - own.first_triangle;
    own.quadric_count = int(records_.quadrics.size()) - own.first_quadric;
    records_.groups[0] = own;
    add_groups(split ? groups_in_order(true) : placed_groups());
    if (motion_) {
      add_rigid_shapes();
      motion_->begin_primitives(records_);
      add_changing_shapes(emitters);
    }
    add_instances(still);
    if (split && still.triangles + still.quadrics > 0) {
      hierarchies_.set_still(still);
      out_.still = still;
    }
  }

  void add_own_shapes(bool moves) {
    for (std::size_t i = 0; i < scene_.shapes.size(); ++i) {
      if (moving_.shapes[i] != moves || (motion_ && (motion_->is_rigid(i) || motion_->changes(i)))) continue;
      start_own_shape(i);
      add_shape(scene_.shapes[i]);
    }
  }

  void start_own_shape(std::size_t i) {
    if (mattes_) matte_ = shape_mattes_[i];
    boundary_ = media_->of_shape(i);
    shape_ = int(i) + 1;
  }

  /// Adds each of the scene's own shapes that move as rigid bodies as a group. Their instances are added
  /// later.
  void add_rigid_shapes() {
    for (std::size_t i = 0; i < scene_.shapes.size(); ++i) {
      if (!motion_->is_rigid(i)) continue;
      start_own_shape(i);
      matte_ = 0;  // see MatteBook::first_of
      const glm::dvec3 center = bounds_of(std::span(&scene_.shapes[i], 1)).center();
      const int group = close_group(open_group(center), [&] { add_shape(scene_.shapes[i]); });
      if (group > 0) rigid_.push_back({i, group, center});
    }
  }

  /// Adds the primitives that move by themselves: shapes that deform or emit, and those that move in groups,
  /// for each placement.
  void add_changing_shapes(const std::vector<Shape>& emitters) {
    for (std::size_t i = 0; i < scene_.shapes.size(); ++i) {
      if (!motion_->changes(i)) continue;
      start_own_shape(i);
      add_changing_shape(-1, i, nullptr, scene_.shapes[i]);
    }
    std::size_t next = 0;
    for (const PlacedGroup& place : placed_) {
      const std::vector<Shape>& shapes = scene_.groups[std::size_t(place.group)].shapes;
      int matte = 0;
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Shape* emitter = emits(shapes[i]) && next < emitters.size() ? &emitters[next++] : nullptr;
        const int number = emitter != nullptr ? 0 : matte++;
        if (!moves_by_itself(place, i)) continue;
        if (mattes_)
          matte_ =
              emitter != nullptr ? mattes_->of_placed(place, shapes[i]) : mattes_->first_of(place) + number;
        boundary_ = media_->of_group(place.group, i);
        shape_ = first_shape(place.group) + int(i);
        if (emitter != nullptr) {
          add_changing_shape(place.group, i, &place, *emitter);
        } else if (auto placed = placed_shape(shapes[i], place.to_world)) {
          add_changing_shape(place.group, i, &place, *placed);
        } else {
          problem_ = placed.error().message;
        }
      }
    }
  }

  void add_changing_shape(int group, std::size_t index, const PlacedGroup* place, const Shape& shape) {
    motion_->begin_shape(group, index, place, records_);
    add_shape(shape);
    motion_->end_shape(records_);
  }

  /// Whether the copy of a group's shape has states of its own.
  [[nodiscard]] bool moves_by_itself(const PlacedGroup& place, std::size_t shape) const {
    return motion_ &&
           (motion_->changes(place.group, shape) ||
            (motion_->moves(place.instance) && emits(scene_.groups[std::size_t(place.group)].shapes[shape])));
  }

  /// The groups that are instanced and whose shapes all are still, or of whose shapes some move. A group
  /// whose instances are hidden at this time is there, too: with it the tables of other frames stay equal.
  [[nodiscard]] std::vector<int> groups_in_order(bool move) const {
    if (placed_.empty()) return {};
    std::vector<bool> used(scene_.groups.size(), false);
    for (const PlacedGroup& place : placed_) used[std::size_t(place.group)] = true;
    if (with_hidden_groups_)
      for (const ShapeInstance& instance : scene_.instances) used[std::size_t(instance.group)] = true;
    // A group may hold instances of groups before it.
    for (std::size_t g = used.size(); g-- > 0;)
      if (used[g])
        for (const ShapeInstance& inside : scene_.groups[g].instances) used[std::size_t(inside.group)] = true;
    std::vector<int> groups;
    for (std::size_t g = 0; g < used.size(); ++g)
      if (used[g] && moving_.groups[g] == move) groups.push_back(int(g));
    return groups;
  }

  /// In the order of their first instances.
  [[nodiscard]] std::vector<int> placed_groups() const {
    std::vector<bool> known(scene_.groups.size(), false);
    std::vector<int> groups;
    for (const PlacedGroup& place : placed_) {
      if (!known[std::size_t(place.group)]) groups.push_back(place.group);
      known[std::size_t(place.group)] = true;
    }
    return groups;
  }

  void add_groups(const std::vector<int>& groups) {
    for (const int group : groups) {
      const auto g = std::size_t(group);
      group_bounds_[g] = bounds_of(scene_.groups[g].shapes);
      group_index_[g] = add_group(group, group_bounds_[g].center());
    }
  }

  void add_instances(StillRecords& still) {
    for (std::size_t i = 0; i < placed_.size(); ++i) {
      if (i == still_placed_) still.instances = int(records_.instances.size());
      if (!(motion_ && motion_->moves(placed_[i].instance))) add_instance(placed_[i]);
    }
    if (still_placed_ == placed_.size()) still.instances = int(records_.instances.size());
    if (motion_) add_moving_instances();
    if (!records_.instances.empty()) {
      need(FEATURE_INSTANCES);
      return;
    }
    // Without instances all primitives are the scene's own.
    is_short_of_instances_ = records_.groups.size() > 1;
    records_.groups.clear();
  }

  /// Returns whether there is something to place.
  bool add_instance(const PlacedGroup& place) {
    const auto g = std::size_t(place.group);
    if (group_index_[g] == 0) return false;
    check_reach(place, group_bounds_[g]);
    records_.instances.push_back(instance(place, group_index_[g], group_bounds_[g].center()));
    if (mattes_) records_.instance_mattes.push_back(mattes_->first_of(place));
    return true;
  }

  void add_moving_instances() {
    motion_->begin_instances(records_);
    for (const PlacedGroup& place : placed_)
      if (motion_->moves(place.instance) && add_instance(place))
        motion_->add_instance(place, group_bounds_[std::size_t(place.group)].center());
    for (const RigidShape& rigid : rigid_) {
      records_.instances.push_back(instance({}, rigid.group, rigid.center));
      if (mattes_) records_.instance_mattes.push_back(shape_mattes_[rigid.shape]);
      motion_->add_rigid(rigid.shape, rigid.center);
    }
  }

  /// The emitting shapes of groups, for each instance, in the order of `placed_`.
  std::vector<Shape> emitters_of_instances() {
    if (!problem_.empty()) return {};
    auto emitters = placed_emitters(scene_, placed_, emits);
    if (emitters) return std::move(*emitters);
    problem_ = emitters.error().message;
    return {};
  }

  /// Adds the emitters of these placements, which are those from `next` on. Returns the next one.
  std::size_t add_emitters(std::span<const PlacedGroup> placed, const std::vector<Shape>& emitters,
                           std::size_t next) {
    if (!problem_.empty()) return next;
    for (const PlacedGroup& place : placed) {
      const std::vector<Shape>& shapes = scene_.groups[std::size_t(place.group)].shapes;
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        if (!emits(shapes[i])) continue;
        const Shape& emitter = emitters[next++];
        if (moves_by_itself(place, i)) continue;
        if (mattes_) matte_ = mattes_->of_placed(place, shapes[i]);
        boundary_ = media_->of_group(place.group, i);
        shape_ = first_shape(place.group) + int(i);
        add_shape(emitter);
      }
    }
    return next;
  }

  /// Returns the index of the group's record, or 0 if all of its shapes emit.
  int add_group(int number, const glm::dvec3& center) {
    const std::vector<Shape>& shapes = scene_.groups[std::size_t(number)].shapes;
    matte_ = 0;  // see MatteBook::first_of
    return close_group(open_group(center), [&] {
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        if (emits(shapes[i])) continue;
        boundary_ = media_->of_group(number, i);
        shape_ = first_shape(number) + int(i);
        if (!(motion_ && motion_->changes(number, i))) add_shape(shapes[i]);
        ++matte_;
      }
    });
  }

  PrimitiveGroup open_group(const glm::dvec3& center) {
    PrimitiveGroup record{};
    record.first_triangle = int(records_.triangles.size());
    record.first_quadric = int(records_.quadrics.size());
    in_group_ = center;
    return record;
  }
  /// `add`: adds the group's shapes. Returns the index of the record, or 0 if it has no primitives.
  int close_group(PrimitiveGroup record, const auto& add) {
    add();
    in_group_.reset();
    record.triangle_count = int(records_.triangles.size()) - record.first_triangle;
    record.quadric_count = int(records_.quadrics.size()) - record.first_quadric;
    if (record.triangle_count + record.quadric_count == 0) return 0;
    records_.groups.push_back(record);
    return int(records_.groups.size()) - 1;
  }

  std::string name_of(const PlacedGroup& place) const {
    return "instance '" + scene_.instances[place.instance].name + "'";
  }

  void check_reach(const PlacedGroup& place, const SceneBounds& group) {
    const SceneBounds there = bounds_of(group, place.to_world);
    const glm::dvec3 far = glm::max(glm::abs(there.low), glm::abs(there.high));
    if (!(std::max({far.x, far.y, far.z}) < kFarthest) && problem_.empty())
      problem_ = fmt::format("{} reaches as far as ({}, {}, {}); single precision reaches {}", name_of(place),
                             far.x, far.y, far.z, kFarthest);
  }

  Instance instance(const PlacedGroup& place, int group, const glm::dvec3& center) {
    const glm::dmat3 there(place.to_world), back = glm::inverse(there);
    Instance i{};
    i.x = to_vec3(there[0]);
    i.y = to_vec3(there[1]);
    i.z = to_vec3(there[2]);
    i.at = local(transform_point(place.to_world, center), [&] { return name_of(place); });
    const glm::dmat3 rows = glm::transpose(back);
    i.row_x = to_vec3(rows[0]);
    i.row_y = to_vec3(rows[1]);
    i.row_z = to_vec3(rows[2]);
    i.group = group;
    return i;
  }

  void add_quadric(const Shape& shape, Quadric q, int front, int back) {
    need(FEATURE_QUADRICS);
    if (q.kind == QUADRIC_CYLINDER) need(FEATURE_CYLINDERS);
    q.front = front;
    q.back = back;
    if (emits(shape))
      q.light = lights_.add_quadric(light_of_quadric(q), shape, quadric_area(shape.geometry), q);
    records_.quadrics.push_back(q);
    if (mattes_) quadric_mattes_.push_back(matte_);
    if (has(FEATURE_SHAPE_LAYER)) quadric_shapes_.push_back(shape_);
    if (!media_->empty()) quadric_boundaries_.push_back(boundary_);
  }

  /// The mattes of triangles are in their table already.
  Expected<void> store_mattes() {
    records_.mattes.insert(records_.mattes.end(), quadric_mattes_.begin(), quadric_mattes_.end());
    *options_.mattes = std::move(*mattes_).names();
    if (options_.mattes->mattes.size() > std::size_t(MAX_MATTES))
      return fail(
          fmt::format("{}: more than {} objects with their materials; Cryptomatte has no numbers "
                      "for them",
                      scene_.source, MAX_MATTES));
    h_.matte_count = int(options_.mattes->mattes.size());
    need(FEATURE_MATTES);
    return {};
  }

  /// The number of the first shape of a group: those of the scene come first, then those of all groups.
  [[nodiscard]] int first_shape(int group) const {
    std::size_t before = scene_.shapes.size();
    for (int g = 0; g < group; ++g) before += scene_.groups[std::size_t(g)].shapes.size();
    return int(before) + 1;
  }

  /// The shapes of triangles are in their table already.
  Expected<void> store_shapes() {
    records_.primitive_shapes.insert(records_.primitive_shapes.end(), quadric_shapes_.begin(),
                                     quadric_shapes_.end());
    const int all = first_shape(int(scene_.groups.size())) - 1;
    if (all > MAX_SHAPES)
      return fail(fmt::format("{}: film.layers: {} shapes; the layer 'shape' has numbers for {}",
                              scene_.source, all, MAX_SHAPES));
    h_.shape_count = all;
    return {};
  }

  void add_other_lights() {
    h_.environment = -1;
    h_.first_sun = h_.sun_count = 0;
    const bool balanced = finds_lights(scene_.integrator) && !has_photons(scene_.integrator);
    const auto at = [&](const glm::dvec3& p) { return local(p, [] { return "a light"; }); };
    // Add emitters kind by kind, so that their order in the file makes no difference.
    for (std::size_t kind = 0; kind < std::variant_size_v<Emitter>; ++kind)
      for (const Emitter& emitter : scene_.emitters) {
        if (emitter.index() != kind || is_black(emitter)) continue;
        const int light = lights_.add_emitter(emitter, {at, radius_, records_, &light_textures_, balanced});
        if (motion_) add_moving_emitter(std::size_t(&emitter - scene_.emitters.data()), light);
        if (is_sky(emitter)) h_.environment = light;
        if (lights_.lights()[std::size_t(light)].kind != LIGHT_SUN) continue;
        if (h_.sun_count == 0) h_.first_sun = light;
        h_.sun_count = light + 1 - h_.first_sun;
      }
    if (samples_media())
      for (const MediumLight& made : medium_lights(h_.camera_medium, medium_boxes(), records_))
        records_.media[std::size_t(made.medium)].light = lights_.add(made.light);
    lights_.finish();
    records_.lights = lights_.lights();
    records_.light_cells = lights_.cells();
    records_.polygons = lights_.polygons();
    records_.polygon_corners = lights_.corners();
    h_.duplicate_lights = lights_.duplicates();
    if ((h_.environment >= 0 || h_.sun_count > 0) && passes_flat_glass())
      each_shape(scene_, [&](const Shape& shape) {
        if (mark_flat_glass(shape, records_.materials)) need(FEATURE_FLAT_GLASS);
      });
  }

  /// The boxes of shapes that contain media. None where shapes move.
  [[nodiscard]] MediumBoxes medium_boxes() const {
    MediumBoxes boxes;
    if (motion_) return boxes;
    const auto add = [&](const Shape& shape, const glm::dmat4& to_world) {
      if (shape.interior == kNoMedium) return;
      SceneBounds box = bounds_of(bounds_of(std::span(&shape, 1)), to_world);
      box.low -= center_;
      box.high -= center_;
      boxes[media_->record_of(shape.interior)].push_back(box);
    };
    for (const Shape& shape : scene_.shapes) add(shape, glm::dmat4(1.0));
    for (const PlacedGroup& placed : placed_)
      for (const Shape& shape : scene_.groups[std::size_t(placed.group)].shapes) add(shape, placed.to_world);
    return boxes;
  }

  /// Whether media are lights: with paths whose light and direction samples are balanced.
  [[nodiscard]] bool samples_media() const {
    return has(FEATURE_EMITTING_MEDIA) && direct_sampling(scene_.integrator) == DirectSampling::kMis &&
           !has_photons(scene_.integrator) && !wants_polygons(scene_.integrator);
  }

  void add_moving_emitter(std::size_t emitter, int light) {
    if (scene_.motion == nullptr) return;
    const std::vector<MovingEmitter>& moving = scene_.motion->emitters;
    for (std::size_t i = 0; i < moving.size(); ++i)
      if (moving[i].emitter == emitter) motion_->add_emitter(i, light);
  }

  /// Whether shadow rays pass plates of glass: with `path` where there are no media, and where no light is
  /// told by the surfaces that scattered it.
  [[nodiscard]] bool passes_flat_glass() const {
    const auto* path = scene_.integrator.get<PathIntegrator>();
    const bool whole = path == nullptr || !keeps_parts(*path);
    return follows_paths() && whole && media_->empty() && !has(FEATURE_DIRECT_LAYER | FEATURE_INDIRECT_LAYER);
  }

  /// Adds everything that is found by tracing rays through the scene, which is complete otherwise.
  Expected<void> trace_pilot_rays() {
    TemporaryHierarchy hierarchy(hierarchies_, records_);
    if ((h_.features & FEATURE_LIGHT_TREE) != 0u)
      if (Expected<void> done =
              add_light_tree(lights_.bounds(), scene_.integrator, radius_, h_, records_, hierarchy);
          !done)
        return done;
    return scene_.film.closed_light_edges && !motion_ ? add_light_edges(h_, records_, hierarchy)
                                                      : Expected<void>();
  }

  void set_camera() {
    const vec3 origin = local(glm::dvec3(scene_.camera.to_world[3]), [] { return "the camera"; });
    h_.camera = build_camera(scene_.camera, scene_.film, origin);
    need(camera_features(scene_.camera));
    if (records_.camera_states.empty()) return;
    h_.own_camera = camera_key(h_.camera);
    h_.camera_moves = 1;
    for (const Camera& state : records_.camera_states)
      if (state.lens_radius > 0) need(FEATURE_CAMERA);
  }

  void set_film() {
    h_.film = film_parameters(scene_.film);
    h_.sampler.kind = int(scene_.sampler.kind);
    h_.sampler.spp = scene_.sampler.spp;
    h_.sampler.seed = scene_.sampler.seed;
  }

  const SceneDescription& scene_;
  const DeviceSceneOptions& options_;
  const MovingParts moving_;
  const bool with_hidden_groups_;
  HierarchySource hierarchies_{options_.hierarchy_cache, options_.earlier};
  DeviceScene out_;
  SceneHeader& h_ = out_.header;
  glm::dvec3 center_{0};
  double radius_ = 0;
  std::vector<PlacedGroup> placed_;  ///< the still ones first
  std::size_t still_placed_ = 0;
  bool uses_tangents_ = false;          ///< by some material, as for a normal map
  bool is_short_of_instances_ = false;  ///< there are groups, but no instance of them has primitives
  std::vector<int> group_index_;        ///< of a group's record; -1: none; 0: it has no primitives
  std::vector<SceneBounds> group_bounds_;
  std::optional<glm::dvec3> in_group_;  ///< the centre of the group whose shapes are being added
  LightBuilder lights_;
  SceneRecords records_;
  LightTextures light_textures_;
  /// Attributes shown by textures, in the order of a triangle's colours.
  std::vector<MeshAttribute> attributes_;
  std::optional<MatteBook> mattes_;
  std::vector<int> shape_mattes_;  ///< of the scene's own shapes
  int matte_ = 0;                  ///< of the shape that is being added
  std::vector<int> quadric_mattes_;
  int shape_ = 0;  ///< the number of the shape that is being added
  std::vector<int> quadric_shapes_;
  std::optional<MediaBook> media_;
  int boundary_ = -1;  ///< of the shape that is being added
  std::vector<int> quadric_boundaries_;
  std::string problem_;
  std::optional<MotionTables> motion_;
  struct RigidShape {
    std::size_t shape;
    int group;
    glm::dvec3 center;
  };
  std::vector<RigidShape> rigid_;
};

}  // namespace

Expected<DeviceScene> build_device_scene(const SceneDescription& scene, const DeviceSceneOptions& options) {
  auto motion = exposed_motion(scene);
  if (!motion) return fail(scene.source + ": " + motion.error().message);
  if (options.warnings != nullptr) {
    *options.warnings = motion->warnings;
    std::ranges::move(interior_warnings(scene), std::back_inserter(*options.warnings));
  }
  const bool moves = motion->any() || motion->has_layer;
  std::optional<SceneDescription> middle;
  if (moves && scene.motion != nullptr) {
    auto there = at_middle(scene, *motion);
    if (!there) return fail(scene.source + ": " + there.error().message);
    middle = std::move(*there);
  }
  const SceneDescription& shown = middle ? *middle : scene;
  const auto build = [&](bool with_hidden_groups, bool& again) {
    SceneBuilder builder(shown, options, moves ? &*motion : nullptr, with_hidden_groups);
    auto built = builder.build();
    again = builder.is_short_of_instances();
    return built;
  };
  bool again = false, never = false;
  auto built = build(true, again);
  if (again) built = build(false, never);
  if (!built) return built;
  // Report it here, not by every worker that would refuse the scene.
  if (const auto checked = check_device_scene(*built); !checked)
    return fail(
        fmt::format("{}: the scene's tables contradict each other, which is a fault of this program: {}",
                    scene.source, checked.error().message));
  return built;
}

}  // namespace penumbra
