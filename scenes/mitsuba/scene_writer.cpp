#include "scenes/mitsuba/scene_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "scenes/curve_reader.h"
#include "scenes/instances.h"
#include "scenes/mesh_writer.h"
#include "scenes/mitsuba/integrator_reader.h"
#include "scenes/mitsuba/medium_writer.h"
#include "scenes/mitsuba/mitsuba3_limits.h"
#include "scenes/mitsuba/plugin_writer.h"
#include "scenes/mitsuba/sensor_parameters.h"
#include "scenes/mitsuba/shape_parameters.h"
#include "scenes/mitsuba/written_motion.h"
#include "scenes/motion/exposure.h"
#include "scenes/settings.h"
#include "scenes/transform.h"

namespace penumbra::mitsuba {
namespace {

namespace fs = std::filesystem;

class SceneWriter {
 public:
  SceneWriter(const SceneDescription& scene, fs::path file) : scene_(scene), file_(std::move(file)) {
    if (scene.motion == nullptr) return;
    for (const MovingShape& moving : scene.motion->shapes)
      moving_shapes_[{moving.group, moving.shape}] = &moving;
    for (const MovingInstance& moving : scene.motion->instances) moving_instances_[moving.instance] = &moving;
  }

  Expected<std::vector<SceneFile>> write() {
    for (const SceneTexture& texture : scene_.textures)
      if (multiplies(texture.model))
        return fail(fmt::format("{} multiplies another texture, which Mitsuba has not", texture.name));
    put_integrator();
    if (std::ranges::any_of(scene_.media, &ParticipatingMedium::emits))
      remark("Mitsuba 3 has no media that emit");
    if (auto done = write_media(scene_, file_, xml_, files_); !done) return std::unexpected(done.error());
    put_sensor();
    put_surfaces();
    // Mitsuba has neither nested instances nor emitters in groups. Both are written as shapes of the scene
    // itself.
    const auto placed = place_groups(scene_);
    if (!placed) return std::unexpected(placed.error());
    const auto emitters = placed_emitters(scene_, *placed, emits);
    if (!emitters) return std::unexpected(emitters.error());
    for (std::size_t i = 0; i < scene_.groups.size(); ++i) {
      const std::vector<Shape>& shapes = scene_.groups[i].shapes;
      if (std::ranges::all_of(shapes, emits)) continue;
      xml_.open("shape", ShapeGroupShape::kPlugin, fmt::format(" id=\"group-{}\"", i));
      for (std::size_t k = 0; k < shapes.size(); ++k) {
        if (emits(shapes[k])) continue;
        if (auto done = put_shape(shapes[k], course_of({}, int(i), k), false); !done)
          return std::unexpected(done.error());
      }
      xml_.close();
    }
    for (std::size_t k = 0; k < scene_.shapes.size(); ++k)
      if (auto done = put_shape(scene_.shapes[k], course_of({}, -1, k)); !done)
        return std::unexpected(done.error());
    if (auto done = put_placed_emitters(*placed, *emitters); !done) return std::unexpected(done.error());
    for (const PlacedGroup& each : *placed)
      if (!std::ranges::all_of(scene_.groups[std::size_t(each.group)].shapes, emits)) put_instance(each);
    if (std::ranges::any_of(scene_.instances, &ShapeInstance::hidden))
      remark(fmt::format("instances without a size at {} s are left out", scene_.time));
    for (std::size_t i = 0; i < scene_.emitters.size(); ++i)
      if (auto done = std::visit([&](const auto& e) { return put_emitter(e, i); }, scene_.emitters[i]); !done)
        return std::unexpected(done.error());
    files_.push_back({file_, "<scene version=\"3.0.0\">\n" + xml_.text() + "</scene>\n"});
    return std::move(files_);
  }
  /// What Mitsuba 3 cannot read of it, each thing once, and what is approximate.
  [[nodiscard]] std::vector<std::string> remarks() const {
    std::vector<std::string> all = refused_;
    const auto others = [](const auto& list) {
      return list.size() == 1 ? "" : fmt::format(", and {} more", list.size() - 1);
    };
    if (!approximate_.empty())
      all.push_back(fmt::format("between its keys the motion of {}{}, is approximate",
                                approximate_.front().first, others(approximate_)));
    if (!stays_.empty())
      all.push_back(fmt::format("{}{}: as at {} s, because keys of matrices cannot have its motion: {}",
                                stays_.front().first, others(stays_), scene_.time, stays_.front().second));
    return all;
  }

 private:
  /// Writes a setting that differs from the value of a file without it.
  void put_setting(const Setting& setting, const RenderSettings& plain, std::string_view name) {
    if (!setting.print || !setting.belongs_to(scene_) || setting.print(scene_) == setting.print(plain))
      return;
    put_always(setting, name);
  }
  void put_always(const Setting& setting, std::string_view name) {
    const std::string text = setting.print(scene_);
    const bool number = setting.kind == SettingKind::kNumber ||
                        (setting.kind == SettingKind::kNumberOrText && text != "auto");
    xml_.value(number                                  ? "float"
               : setting.kind == SettingKind::kInteger ? "integer"
               : setting.kind == SettingKind::kBoolean ? "boolean"
                                                       : "string",
               name, text);
  }
  void put_always(std::string_view key) {
    const Setting* setting = find_setting(key);
    put_always(*setting, setting->name());
  }

  void put_integrator() {
    RenderSettings plain;
    use_integrator(plain.integrator, scene_.integrator.method);
    for (const IntegratorMethod& method : integrator_methods())
      if (method.index() == scene_.integrator.method.index()) plain.integrator.method = method;
    plain.integrator.hide_emitters = false;
    // The rule of version 3. It only matters if emitters are hidden.
    plain.integrator.hidden_emitters =
        scene_.integrator.hide_emitters ? HiddenEmitters::kLookedThrough : scene_.integrator.hidden_emitters;
    const std::string aovs = aovs_of(scene_.film.layers);
    if (!aovs.empty()) {
      xml_.open("integrator", "aov");
      xml_.value("string", "aovs", aovs);
    }
    xml_.open("integrator", method_name(scene_.integrator.method));
    for (const Setting& setting : all_settings())
      if (setting.key.starts_with("integrator.") && setting.name() != "type" &&
          !affects_only_noise(setting.name()))
        put_setting(setting, plain, setting.name());
    xml_.close();
    if (!aovs.empty()) xml_.close();
  }

  /// For integrators that Mitsuba 3 has too: whether the parameter has no name there and affects only the
  /// noise.
  [[nodiscard]] bool affects_only_noise(std::string_view name) const {
    static constexpr std::string_view kWays[] = {
        "direct_sampling", "emitter_sampling", "bsdf_sampling", "light_choice", "mis", "nee", "alpha"};
    const IntegratorSettings& ours = scene_.integrator;
    const bool shared =
        ours.is<PathIntegrator>() || ours.is<VolpathIntegrator>() || ours.is<DirectIntegrator>();
    return shared && std::ranges::find(kWays, name) != std::end(kWays);
  }

  /// Whether a texture of its own values multiplies another one.
  static bool multiplies(const TextureModel& model) {
    return std::visit(
        [](const auto& texture) {
          if constexpr (requires { texture.times; }) return texture.times != kNoTexture;
          return false;
        },
        model);
  }

  void remark(std::string text) {
    if (std::ranges::find(refused_, text) == refused_.end()) refused_.push_back(std::move(text));
  }

  /// Writes a transform over time, or if it does not change a plain one.
  void put_motion(const std::function<glm::dmat4(double)>& at, std::span<const double> times,
                  std::string_view what) {
    const auto made = written_keys(at, times);
    if (!made) stays_.emplace_back(what, made.error().message);
    const bool moves = made && std::ranges::any_of(made->keys, [&](const TransformKey& key) {
                         return key.transform != made->keys.front().transform;
                       });
    if (!moves) return xml_.transform("to_world", affine(at(scene_.time)));
    remark("Mitsuba 3 has no <animation>, which was in Mitsuba 0.6");
    if (!made->exact) approximate_.emplace_back(what, "");
    xml_.animation("to_world", made->keys);
  }
  /// The same for what is placed by `end` on a course.
  void put_motion(const Course& course, const glm::dmat4& end, std::string_view what) {
    const SceneMotion& motion = *scene_.motion;
    put_motion([&](double time) { return course.at(motion, time) * end; }, course.times(motion), what);
  }

  /// A shape that moves.
  struct MovingCourse : Course {
    Geometry geometry;                 ///< a mesh: at the course's end
    glm::dmat4 end{1.0};               ///< from another geometry's space to the course's end
    bool is_smooth = false;            ///< a mesh without normals gets some when it is read
    std::vector<MeshKey> meshes = {};  ///< of one that deforms, instead of `geometry`
  };
  /// That of a shape of a group, or of the scene, from the end of the course before it. Nothing if neither
  /// moves, or if the shape deforms and the shutter does not open.
  std::optional<MovingCourse> course_of(Course before, int group, std::size_t index) {
    const auto known = moving_shapes_.find({group, index});
    const bool is_own = known != moving_shapes_.end();
    if (!is_own && before.steps.empty()) return std::nullopt;
    const MovingShape* found = is_own ? known->second : nullptr;
    const Shape& shape = (group < 0 ? scene_.shapes : scene_.groups[std::size_t(group)].shapes)[index];
    const bool deforms = is_own && found->deformation != nullptr;
    const Exposure exposure = exposure_of(scene_);
    if (deforms && !(exposure.close > exposure.open)) {
      remark(fmt::format("the mesh '{}' deforms; it is as at {} s", shape.name, scene_.time));
      return std::nullopt;
    }
    MovingCourse course;
    course.steps = std::move(before.steps);
    course.geometry = is_own ? found->rest : shape.geometry;
    if (deforms) put_deformation(*found, exposure, shape.name, course);
    course.is_smooth = is_own && !found->is_faceted;
    if (is_own) course.steps.push_back(found->place);
    const glm::dmat4 now = course.at(*scene_.motion, scene_.time);
    if (is_singular(now)) {
      stays_.emplace_back(fmt::format("the shape '{}'", shape.name), "it is flat then");
      return std::nullopt;
    }
    const bool mirrors = is_mirror(now);
    const glm::dmat4 end = course.take_end();
    const auto place = [&](Mesh& mesh) {
      for (glm::dvec3& p : mesh.positions) p = transform_point(end, p);
      const glm::dmat3 matrix = normal_matrix(end);
      // Those of a mesh that deforms keep their lengths, which are weights between keys.
      for (glm::vec3& n : mesh.normals) {
        const glm::dvec3 turned = matrix * glm::dvec3(n);
        n = glm::vec3(course.meshes.empty() ? glm::normalize(turned) : turned);
      }
      // The reader keeps the winding of meshes without normals, whatever mirrors them.
      transform_tangents(mesh, end);
      if (mesh.normals.empty() && mirrors)
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) turn_over(mesh, i);
    };
    if (auto* mesh = std::get_if<Mesh>(&course.geometry))
      place(*mesh);
    else
      course.end = end;
    for (MeshKey& key : course.meshes) place(key.mesh);
    return course;
  }

  /// The meshes of one that deforms while the shutter is open, and from frame to frame if the layer of motion
  /// is wanted.
  void put_deformation(const MovingShape& moving, const Exposure& exposure, const std::string& name,
                       MovingCourse& course) {
    double from = exposure.open, to = exposure.close;
    if (std::ranges::find(scene_.film.layers, AskedLayer::kMotion) != scene_.film.layers.end()) {
      from = std::min(from, exposure.before);
      to = std::max(to, exposure.after);
    }
    WrittenMeshes made = written_meshes(*scene_.motion, moving, from, to);
    if (!made.exact) approximate_.emplace_back(fmt::format("the mesh '{}'", name), "");
    if (std::ranges::all_of(made.keys, [&](const MeshKey& key) {
          return key.mesh.positions == made.keys.front().mesh.positions &&
                 key.mesh.normals == made.keys.front().mesh.normals;
        }))
      course.geometry = std::move(made.keys.front().mesh);
    else
      course.meshes = std::move(made.keys);
    remark(fmt::format("meshes deform only from {} to {} s", from, to));
  }

  /// The place of an instance that moves, and of a group inside it.
  [[nodiscard]] Course course_of(const PlacedGroup& placed) const {
    const auto known = moving_instances_.find(placed.instance);
    if (known == moving_instances_.end()) return {};
    const glm::dmat4& now = scene_.instances[placed.instance].to_world;
    Course course{{known->second->place}};
    if (placed.to_world != now) course.steps.push_back({-1, glm::inverse(now) * placed.to_world});
    return course;
  }

  /// `emitters`: see placed_emitters.
  Expected<void> put_placed_emitters(std::span<const PlacedGroup> placed, std::span<const Shape> emitters) {
    std::size_t next = 0;
    for (const PlacedGroup& place : placed) {
      const std::vector<Shape>& shapes = scene_.groups[std::size_t(place.group)].shapes;
      for (std::size_t k = 0; k < shapes.size(); ++k) {
        if (!emits(shapes[k])) continue;
        Course before = course_of(place);
        auto course = course_of(before, place.group, k);
        if (course && before.steps.empty()) {  // an instance that does not move, of a shape that does
          before.steps.push_back({-1, place.to_world});
          course = course_of(std::move(before), place.group, k);
        }
        if (auto done = put_shape(emitters[next++], std::move(course)); !done) return done;
      }
    }
    return {};
  }

  void put_medium(int index, std::string_view name) {
    if (index != kNoMedium) xml_.reference(fmt::format("medium-{}", index), name);
  }

  void put_sensor() {
    const CameraSettings& camera = scene_.camera;
    const bool flat = camera.projection == Projection::kOrthographic, lens = camera.aperture_radius > 0;
    const auto panorama = std::ranges::find(kPanoramas, camera.projection, &PanoramaPlugin::projection);
    const bool round = panorama != kPanoramas.end();
    xml_.open("sensor", round  ? panorama->type
                        : flat ? (lens ? "telecentric" : "orthographic")
                        : lens ? "thinlens"
                               : "perspective");
    const bool has_angle = !flat && !round;
    if (has_angle) put_always("camera.fov");
    if (has_angle) put_always("camera.fov_axis");
    if (lens) put_always("camera.aperture_radius");
    if (lens) put_always("camera.focus_distance");
    const RenderSettings plain;
    for (const Setting& setting : all_settings()) {
      const std::string name = setting.name();
      if (!setting.key.starts_with("camera.") || name == "to_world" || name == "projection" ||
          name == "fov" || (name == "fov_axis" && !round) || name == "scale_x" || name == "scale_y" ||
          name == "aperture_radius" || name == "focus_distance" || name == "shutter" ||
          name == "shutter_position")
        continue;
      const bool is_own =
          round && std::ranges::find(panorama->parameters, name) != panorama->parameters.end();
      const bool of_panorama = std::ranges::any_of(kPanoramas, [&](const PanoramaPlugin& each) {
        return std::ranges::find(each.parameters, name) != each.parameters.end();
      });
      if (of_panorama && !is_own) continue;
      const bool of_lens = name.starts_with("blade") || name.starts_with("refocus");
      const bool of_motion = name == "shutter_curve" || name == "rolling_shutter";
      if ((lens || !of_lens) && (scene_.motion != nullptr || !of_motion)) put_setting(setting, plain, name);
    }
    put_camera_place(flat);
    // Mitsuba 3's name of the sampler. Only Sobol's differs, and Halton points are no longer available there.
    const bool sobol = scene_.sampler.kind == SamplerKind::kSobol;
    xml_.open("sampler", sobol ? "ldsampler" : print_setting(scene_, "sampler.type"));
    put_always("sampler.sample_count");
    put_setting(*find_setting("sampler.seed"), plain, "seed");
    xml_.close();
    put_film(plain);
    put_medium(scene_.camera_medium, "medium");
    xml_.close();
  }

  /// When the shutter opens, and closes for the first row.
  void put_shutter() {
    if (scene_.motion == nullptr) return;
    const Exposure exposure = exposure_of(scene_);
    const double close = exposure.open + exposure.exposure * (exposure.close - exposure.open);
    if (exposure.open == 0.0 && close == 0.0) return;
    xml_.value("float", "shutter_open", fmt::format("{}", exposure.open));
    xml_.value("float", "shutter_close", fmt::format("{}", close));
  }

  void put_camera_place(bool flat) {
    const CameraSettings& camera = scene_.camera;
    put_shutter();
    const auto placed = [&](const glm::dmat4& frame, double x, double y) {
      return flat ? frame * scaling({x, y, 1.0}) : frame;
    };
    const glm::dmat4 now = placed(camera.to_world, camera.scale_x, camera.scale_y);
    if (scene_.motion == nullptr || !scene_.motion->camera) return xml_.transform("to_world", now);
    const MovingCamera& moving = *scene_.motion->camera;
    const Course course{{moving.place}};
    std::vector<double> times = course.times(*scene_.motion);
    if (flat)
      for (const auto* keys : {&moving.scale_x, &moving.scale_y})
        if (*keys) times.insert(times.end(), (*keys)->times.begin(), (*keys)->times.end());
    std::ranges::sort(times);
    times.erase(std::ranges::unique(times).begin(), times.end());
    const auto at = [&](double time) {
      const auto frame = camera_frame(course.at(*scene_.motion, time));
      const auto scale = [&](const auto& keys, double value) { return keys ? value_at(*keys, time) : value; };
      return placed(frame ? *frame : camera.to_world, scale(moving.scale_x, camera.scale_x),
                    scale(moving.scale_y, camera.scale_y));
    };
    put_motion(at, times, "the sensor");
    const auto varies = [](const auto& keys) { return keys && keys->varies(); };
    if (varies(moving.fov) || varies(moving.focus_distance) || varies(moving.aperture_radius))
      remark(fmt::format("the sensor's angle of view, focus and aperture are as at {} s", scene_.time));
  }

  void put_film(const RenderSettings& plain) {
    const Film& film = scene_.film;
    xml_.open("film", "hdrfilm");
    put_always("film.width");
    put_always("film.height");
    if (film.crop_x != 0 || film.crop_y != 0 || film.crop_width != film.width ||
        film.crop_height != film.height)
      for (const char* key :
           {"film.crop_offset_x", "film.crop_offset_y", "film.crop_width", "film.crop_height"})
        put_always(key);
    if (film.alpha) put_always("film.pixel_format");
    if (film.half) put_always("film.component_format");
    xml_.open("rfilter", print_setting(scene_, "film.rfilter"));
    if (film.filter == FilterKind::kTent && film.filter_radius != 1.0f)
      xml_.value("float", "radius", print_setting(scene_, "film.rfilter_radius"));
    if (film.filter == FilterKind::kGaussian)
      put_setting(*find_setting("film.rfilter_stddev"), plain, "stddev");
    if (film.filter == FilterKind::kLanczos)
      xml_.value("integer", "lobes", fmt::format("{}", std::lround(film.filter_radius)));
    if (film.filter == FilterKind::kMitchell) {
      put_setting(*find_setting("film.rfilter_b"), plain, "b");
      put_setting(*find_setting("film.rfilter_c"), plain, "c");
    }
    xml_.close();
    xml_.close();
  }

  XmlText new_text() {
    return XmlText(
        [this](int index, TextureUse use, std::string_view name) { put_texture(index, use, name); },
        [this](std::string_view tag, std::string_view type, std::string_view parameter) {
          const std::string why = why_mitsuba3_refuses(tag, type, parameter);
          if (!why.empty() && std::ranges::find(refused_, why) == refused_.end()) refused_.push_back(why);
        });
  }

  /// Writes a texture at its first use, and a reference later.
  void put_texture(int index, TextureUse use, std::string_view name) {
    if (!textures_.insert(index).second) return xml_.reference(texture_id(index), name);
    const SceneTexture& texture = scene_.textures[std::size_t(index)];
    const std::string named = name.empty() ? "" : fmt::format(" name=\"{}\"", name);
    std::visit(
        [&](auto model) {
          using Model = decltype(model);
          if constexpr (std::is_same_v<Model, BitmapTexture>)
            model.filename = image_file(*scene_.bitmaps[std::size_t(model.bitmap)]);
          // The reader exchanges the colours of a checkerboard used as a number, as Mitsuba does.
          if constexpr (std::is_same_v<Model, CheckerboardTexture>)
            if (use == TextureUse::kNumber) std::swap(model.color0, model.color1);
          xml_.open("texture", Model::kPlugin, fmt::format(" id=\"{}\"{}", texture_id(index), named));
          put_parameters(xml_, model);
          if constexpr (requires { model.texture; }) xml_.texture(model.texture, use);
          const glm::dmat3& m = texture.to_uv;
          if (m != glm::dmat3(1.0)) {
            glm::dmat4 to_uv(1.0);
            to_uv[0] = {m[0].x, m[0].y, 0, 0};
            to_uv[1] = {m[1].x, m[1].y, 0, 0};
            to_uv[3] = {m[2].x, m[2].y, 0, 1};
            xml_.transform("to_uv", to_uv);
          }
          xml_.close();
        },
        texture.model);
  }

  /// A path relative to the scene file.
  [[nodiscard]] std::string relative(const fs::path& name) const {
    std::error_code ignored;
    const auto canonical = [&](const fs::path& path) {
      return fs::weakly_canonical(fs::absolute(path), ignored);
    };
    return canonical(name).lexically_proximate(canonical(file_).parent_path()).string();
  }

  /// The path of the image's file relative to the scene file. A computed image is written to a new file.
  std::string image_file(const Bitmap& image) {
    if (image.contents == nullptr) return relative(image.name);
    const auto [at, added] =
        images_.try_emplace(*image.contents, fmt::format("{}-{}{}", file_.stem().string(), images_.size(),
                                                         fs::path(image.name).extension().string()));
    if (added) files_.push_back({file_.parent_path() / at->second, *image.contents});
    return at->second;
  }

  /// The scene's id, unless it is already used. Mitsuba allows no dots in ids. If there is no id, `other` is
  /// used.
  std::string new_id(std::string id, const std::string& other) {
    std::ranges::replace(id, '.', '_');
    const bool is_ours = id.starts_with("medium-") || id.starts_with("group-") || id.starts_with("texture-");
    if (id.empty() || is_ours || ids_.contains(id)) id = other;
    while (!ids_.insert(id).second) id += '_';
    return id;
  }

  [[nodiscard]] const Bsdf* bsdf_at(int index) const {
    return index >= 0 ? &scene_.bsdfs[std::size_t(index)] : nullptr;
  }
  template <typename Model>
  [[nodiscard]] const Model* get(int index) const {
    const Bsdf* bsdf = bsdf_at(index);
    return bsdf != nullptr ? std::get_if<Model>(&bsdf->model) : nullptr;
  }

  /// Writes the BSDFs of all shapes in the order of their textures, so that reading numbers the textures in
  /// the same way.
  void put_surfaces() {
    std::multimap<int, XmlText> surfaces;  // keyed by their first textures
    const auto put = [&](const Shape& shape, bool has_emitter) {
      const std::pair sides{shape.front_bsdf, shape.back_bsdf};
      if (has_emitter && sides == std::pair{kBlackBsdf, kBlackBsdf}) return;
      const auto [at, added] = surfaces_.try_emplace(sides);
      if (!added) return;
      at->second = new_id(shape.material, fmt::format("bsdf-{}", surfaces_.size() - 1));
      const XmlText before = std::exchange(xml_, new_text());
      put_surface(sides.first, sides.second, fmt::format(" id=\"{}\"", escaped(at->second)));
      const XmlText text = std::exchange(xml_, before);
      surfaces.emplace(text.least_texture(), text);
    };
    for (const Shape& shape : scene_.shapes) put(shape, shape.radiance.has_value());
    for (const ShapeGroup& group : scene_.groups)
      for (const Shape& shape : group.shapes) put(shape, emits(shape));
    for (const auto& [first, text] : surfaces) xml_.append(text);
  }

  /// Writes a plugin that a reader converts back to the same front and back.
  void put_surface(int front, int back, const std::string& attributes = "") {
    if (front == kNoBsdf || get<NullBsdf>(front) != nullptr) {
      xml_.open("bsdf", NullBsdf::kPlugin, attributes);
      return xml_.close();
    }
    const auto* mask = get<MaskBsdf>(front);
    const auto* blend = get<BlendBsdf>(front);
    if (mask != nullptr || blend != nullptr) {
      const Bsdf* holder = bsdf_at(front);
      std::visit(
          [&](const auto& model) {
            using Model = std::remove_cvref_t<decltype(model)>;
            xml_.open("bsdf", Model::kPlugin, attributes);
            put_parameters(xml_, model);
          },
          holder->model);
      if (mask != nullptr) {
        const auto* behind = get<MaskBsdf>(back);
        put_surface(mask->inside, behind != nullptr ? behind->inside : kBlackBsdf);
      } else {
        const auto* behind = get<BlendBsdf>(back);
        put_surface(blend->first, behind != nullptr ? behind->first : kBlackBsdf);
        put_surface(blend->second, behind != nullptr ? behind->second : kBlackBsdf);
      }
      return xml_.close();
    }
    const Bsdf *ahead = bsdf_at(front), *behind = bsdf_at(back);
    if (ahead != nullptr && behind != nullptr && front != back) {
      std::vector<LayerBend> turned = bends_of(*ahead);
      for (LayerBend& each : turned) each.bend.scale = -each.bend.scale;
      if (!turned.empty() && bends_of(*behind) == turned) {
        open_bends(*ahead, attributes);
        put_sides(front, back, "", false);
        for (std::size_t i = 0; i < turned.size(); ++i) xml_.close();
        return;
      }
    }
    put_sides(front, back, attributes, true);
  }

  /// For two leaf or black BSDFs, with their bump or normal maps.
  void put_sides(int front, int back, const std::string& attributes, bool bent) {
    const bool two_sides = back != kBlackBsdf && !has_own_back(front);
    const Bsdf *ahead = bsdf_at(front), *behind = bsdf_at(back);
    if (ahead != nullptr && behind != nullptr && std::holds_alternative<HairBsdf>(ahead->model) &&
        std::holds_alternative<NullBsdf>(behind->model))
      remark("hair on curves is written as hair on both sides of tubes, which scatter light twice");
    if (!two_sides) return put_leaf(front, attributes, bent);
    xml_.open("bsdf", TwoSidedParameters::kPlugin, attributes);
    put_leaf(front, "", bent);
    if (back != front && bent) put_leaf(back, "", bent);
    xml_.close();
  }

  /// Whether its plugin defines a back by itself.
  [[nodiscard]] bool has_own_back(int front) const {
    const Bsdf* bsdf = bsdf_at(front);
    return bsdf != nullptr && std::visit(
                                  [](const auto& model) {
                                    using Model = std::remove_cvref_t<decltype(model)>;
                                    if constexpr (requires { Model::kSidesAreAlike; })
                                      return true;
                                    else if constexpr (requires { model.other_side(); })
                                      return std::optional<BsdfModel>(model.other_side()).has_value() &&
                                             transmits(model);
                                    else
                                      return false;
                                  },
                                  bsdf->model);
  }
  template <typename Model>
  static bool transmits(const Model& model) {
    if constexpr (requires { model.other_side().has_value(); }) return model.other_side().has_value();
    return true;
  }

  struct LayerBend {
    SurfaceBend bend;
    BentLayers layers;
    friend bool operator==(const LayerBend&, const LayerBend&) = default;
  };
  /// The outer one first.
  static std::vector<LayerBend> bends_of(const Bsdf& bsdf) {
    std::vector<LayerBend> bends;
    const BentLayers rest = bsdf.coat_bend ? BentLayers::kBase : BentLayers::kAll;
    if (bsdf.coat_bend && bsdf.coat_bend->kind != BendKind::kNone)
      bends.push_back({*bsdf.coat_bend, BentLayers::kCoat});
    if (bsdf.bend.kind != BendKind::kNone) bends.push_back({bsdf.bend, rest});
    return bends;
  }
  void open_bends(const Bsdf& bsdf, std::string attributes) {
    for (const LayerBend& each : bends_of(bsdf))
      open_bend(each.bend, each.layers, std::exchange(attributes, ""));
  }

  void open_bend(const SurfaceBend& bend, BentLayers layers, const std::string& attributes) {
    const auto open = [&](auto parameters) {
      using Parameters = decltype(parameters);
      parameters.use_shadowing_function = bend.shadows;
      parameters.layers = layers;
      if constexpr (requires { parameters.scale; }) parameters.scale = bend.scale;
      xml_.open("bsdf", Parameters::kPlugin, attributes);
      put_parameters(xml_, parameters);
    };
    bend.kind == BendKind::kNormalMap ? open(NormalMapParameters{}) : open(BumpMapParameters{});
    xml_.texture(bend.texture, TextureUse::kColour);
  }

  void put_leaf(int index, const std::string& attributes, bool bent) {
    const Bsdf* bsdf = bsdf_at(index);
    if (bsdf == nullptr) {
      xml_.open("bsdf", DiffuseBsdf::kPlugin, attributes);
      xml_.value("rgb", "reflectance", "0, 0, 0");
      return xml_.close();
    }
    const std::size_t bends = bent ? bends_of(*bsdf).size() : 0;
    if (bends > 0) open_bends(*bsdf, attributes);
    const bool turns = bsdf->turn.turns();
    if (turns) {
      xml_.open("bsdf", TurnedTangentParameters::kPlugin, bends > 0 ? "" : attributes);
      put_parameters(xml_, TurnedTangentParameters{glm::degrees(bsdf->turn.angle), bsdf->turn.mirrored});
      if (bsdf->turn.texture != kNoTexture) xml_.texture(bsdf->turn.texture, TextureUse::kColour);
    }
    std::visit(
        [&](auto model) {
          using Model = decltype(model);
          if constexpr (std::is_same_v<Model, MeasuredBsdf>) model.filename = relative(model.filename);
          xml_.open("bsdf", Model::kPlugin, bends > 0 || turns ? "" : attributes);
          put_parameters(xml_, model);
          xml_.close();
        },
        bsdf->model);
    if (turns) xml_.close();
    for (std::size_t i = 0; i < bends; ++i) xml_.close();
  }

  void put_instance(const PlacedGroup& placed) {
    xml_.open("shape", InstanceShape::kPlugin);
    if (const Course course = course_of(placed); !course.steps.empty())
      put_motion(course, glm::dmat4(1.0),
                 fmt::format("the instance '{}'", scene_.instances[placed.instance].name));
    else
      xml_.transform("to_world", placed.to_world);
    xml_.reference(fmt::format("group-{}", placed.group));
    xml_.close();
  }

  /// Groups have no emitters; black ones are left out there.
  Expected<void> put_shape(const Shape& shape, const std::optional<MovingCourse>& course,
                           bool with_emitter = true) {
    const Geometry& geometry = course ? course->geometry : shape.geometry;
    const std::string what = fmt::format("the shape '{}'", shape.name);
    // Writes the frame of a shape, and returns where in it the shape is. If the shape moves, its centre is
    // not put into the keys: a translation before a turn would be interpolated otherwise.
    const auto put_frame = [&](const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z, double size,
                               const glm::dvec3& at, bool has_center) {
      glm::dmat4 frame(glm::dvec4(size * x, 0), glm::dvec4(size * y, 0), glm::dvec4(size * z, 0),
                       glm::dvec4(at, 1));
      if (!course) return xml_.transform("to_world", frame), glm::dvec3(0.0);
      frame = course->end * frame;
      glm::dvec3 center(0.0);
      if (has_center) {
        center = glm::inverse(glm::dmat3(frame)) * glm::dvec3(frame[3]);
        frame[3] = glm::dvec4(0, 0, 0, 1);
      }
      return put_motion(*course, frame, what), center;
    };
    bool flipped = shape.flip_normals;
    const std::string own = shape.id.empty() ? "" : new_id(shape.id, fmt::format("shape-{}", ids_.size())),
                      id = own.empty() ? "" : fmt::format(" id=\"{}\"", escaped(own));
    if (const auto* mesh = std::get_if<Mesh>(&geometry)) {
      const auto put_file = [&](const Mesh& written) {
        std::string name = fmt::format("{}-{}.ply", file_.stem().string(), meshes_++);
        files_.push_back({file_.parent_path() / name, ply_of(written)});
        return name;
      };
      xml_.open("shape", PlyShape::kPlugin, id);
      if (course && !course->meshes.empty()) {
        std::vector<std::pair<double, std::string>> files;
        for (const auto& [time, written] : course->meshes) files.emplace_back(time, put_file(written));
        xml_.animation("filename", files);
      } else {
        xml_.value("string", "filename", put_file(*mesh));
      }
      if (mesh->normals.empty() && !(course && course->is_smooth))
        xml_.value("boolean", "face_normals", "true");
      if (mesh->computes_tangents) xml_.value("string", "tangents", "mikktspace");
      if (shape.mirrors_maps) xml_.value("boolean", "mirrored_maps", "true");
      if (course) put_motion(*course, glm::dmat4(1.0), what);
    } else if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
      xml_.open("shape", SphereShape::kPlugin, id);
      const glm::dvec3 center =
          put_frame(sphere->x_axis, sphere->y_axis, sphere->z_axis, 1.0, sphere->center, true);
      if (center != glm::dvec3(0.0))
        xml_.value("point", "center", fmt::format("{}, {}, {}", center.x, center.y, center.z));
      xml_.value("float", "radius", fmt::format("{}", sphere->radius));
      // The reader turns it inside out if its transform mirrors.
      if (glm::dot(glm::cross(sphere->x_axis, sphere->y_axis), sphere->z_axis) < 0) flipped = !flipped;
      if (course && is_mirror(course->at(*scene_.motion, scene_.time) * course->end)) flipped = !flipped;
    } else if (const auto* disk = std::get_if<Disk>(&geometry)) {
      xml_.open("shape", DiskShape::kPlugin, id);
      put_frame(disk->x_axis, disk->y_axis, disk->normal, disk->radius, disk->center, false);
    } else if (const auto* cylinder = std::get_if<Cylinder>(&geometry)) {
      xml_.open("shape", CylinderShape::kPlugin, id);
      const glm::dvec3 p0 =
          put_frame(cylinder->x_axis, cylinder->y_axis, cylinder->axis, 1.0, cylinder->center, true);
      xml_.value("float", "radius", fmt::format("{}", cylinder->radius));
      if (p0 != glm::dvec3(0.0)) xml_.value("point", "p0", fmt::format("{}, {}, {}", p0.x, p0.y, p0.z));
      xml_.value("point", "p1", fmt::format("{}, {}, {}", p0.x, p0.y, p0.z + cylinder->length));
    } else if (const auto* curves = std::get_if<Curves>(&geometry)) {
      const std::string name = fmt::format("{}-{}.txt", file_.stem().string(), meshes_++);
      files_.push_back({file_.parent_path() / name, text_of(*curves)});
      if (!curves->ranges.empty())
        remark("curves with parameters of their own are in a file that Mitsuba does not read");
      const bool balls = curves->form == CurveForm::kBalls;
      xml_.open("shape", balls ? LinearCurveShape::kPlugin : BsplineCurveShape::kPlugin, id);
      xml_.value("string", "filename", name);
      if (!balls) {
        BsplineCurveShape parameters;
        parameters.form = curves->form;
        put_parameters(xml_, parameters);
      }
    }
    if (flipped) xml_.value("boolean", "flip_normals", "true");
    if (const auto known = surfaces_.find({shape.front_bsdf, shape.back_bsdf}); known != surfaces_.end())
      xml_.reference(escaped(known->second));
    put_medium(shape.interior, "interior");
    put_medium(shape.exterior, "exterior");
    if (shape.radiance && with_emitter) {
      xml_.open("emitter", AreaLightParameters::kPlugin);
      if (shape.unseen_emission)
        return fail(fmt::format("{} lights other shapes unseen, which Mitsuba has not", shape.name));
      if (shape.radiance_texture != kNoTexture && *shape.radiance != glm::vec3(1.0f))
        return fail(
            fmt::format("{} has a radiance that multiplies a texture, which Mitsuba has not", shape.name));
      AreaLightParameters light{.radiance = *shape.radiance, .two_sided = shape.two_sided_emission};
      light.radiance.texture = shape.radiance_texture;
      light.seen_by_camera = shape.camera_sees_emission;
      light.spread = shape.emission_spread;
      light.sampling = shape.sampling;
      put_parameters(xml_, light);
      if (light.radiance == AreaLightParameters{}.radiance) xml_.value("rgb", "radiance", "1, 1, 1");
      xml_.close();
    }
    xml_.close();
    return {};
  }

  /// Writes how an emitter moves, and takes its place out of its parameters.
  template <typename Light>
  void put_emitter_motion(const MovingEmitter& moving, Light& light) {
    if (moving.colour || moving.strength)
      remark(fmt::format("the strength of an emitter '{}' is that at {} s", Light::kPlugin, scene_.time));
    const auto& rest = std::get<Light>(moving.rest);
    Course course{{moving.place}};
    const glm::dmat4 end = course.take_end();
    const std::string what = fmt::format("an emitter '{}'", Light::kPlugin);
    if (course.times(*scene_.motion).empty()) return;
    if (!std::is_same_v<Light, PointLight> && is_singular(course.at(*scene_.motion, scene_.time))) return;
    if constexpr (std::is_same_v<Light, PointLight>) {
      const auto at = [&](double time) {
        return translation(transform_point(course.at(*scene_.motion, time) * end, rest.position));
      };
      put_motion(at, course.times(*scene_.motion), what);
      light.position = Light{}.position;
    } else if constexpr (std::is_same_v<Light, DirectionalLight>) {
      const auto frame = look_at(glm::dvec3(0.0), transform_vector(end, rest.direction), std::nullopt);
      if (!frame) return;
      put_motion(course, *frame, what);
      light.direction = Light{}.direction;
    } else if constexpr (!std::is_same_v<Light, ConstantEnvironment>) {
      put_motion(course, end * rest.to_world, what);
      light.to_world = Light{}.to_world;
    }
  }

  template <typename Light>
  Expected<void> put_emitter(Light light, std::size_t index) {
    xml_.open("emitter", Light::kPlugin);
    if constexpr (requires { light.image; }) {
      if (light.image->contents == nullptr && !fs::exists(light.image->name))
        return fail(fmt::format("the image of the environment, '{}', is no file that another could refer to",
                                light.image->name));
      light.filename = image_file(*light.image);
    }
    if (scene_.motion != nullptr)
      for (const MovingEmitter& moving : scene_.motion->emitters)
        if (moving.emitter == index) put_emitter_motion(moving, light);
    put_parameters(xml_, light);
    xml_.close();
    return {};
  }

  const SceneDescription& scene_;
  const fs::path file_;
  std::map<std::pair<int, std::size_t>, const MovingShape*> moving_shapes_;  ///< by group and index
  std::map<std::size_t, const MovingInstance*> moving_instances_;
  std::vector<std::string> refused_;
  /// What moves otherwise between its keys, and what does not move; with the reason.
  std::vector<std::pair<std::string, std::string>> approximate_, stays_;
  XmlText xml_ = new_text();
  std::vector<SceneFile> files_;
  int meshes_ = 0;                                       ///< number of meshes so far
  std::map<std::string, std::string> images_;            ///< file names of images
  std::set<std::string> ids_;                            ///< of shapes and BSDFs
  std::set<int> textures_;                               ///< textures already written
  std::map<std::pair<int, int>, std::string> surfaces_;  ///< ids of BSDFs by front and back
};

}  // namespace

Expected<std::vector<SceneFile>> scene_files(const SceneDescription& scene, const fs::path& file,
                                             std::vector<std::string>* refused) {
  SceneWriter writer(scene, file);
  auto files = writer.write();
  if (refused != nullptr) *refused = writer.remarks();
  return files;
}

}  // namespace penumbra::mitsuba
