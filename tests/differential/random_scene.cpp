#include "tests/differential/random_scene.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "scenes/transform.h"
#include "tests/differential/random.h"
#include "tests/differential/random_settings.h"

namespace penumbra::differential {
namespace {

struct Ball {
  glm::dvec3 center{0.0};
  double radius = 0;
};

enum class Freedom { kAny, kDisk, kSphere };

class Generator {
 public:
  explicit Generator(std::uint32_t seed)
      : random_(0x9e3779b97f4a7c15u * (seed + 1)),
        beams_(0xd1b54a32d192ed03u * (seed + 1)),
        unit_(random_.one_of({0.3, 1.0, 1.0, 40.0})),
        plan_(plan_integrator(int(seed % 12), random_)) {
    scene_.name = fmt::format("{}", seed);
    scene_.embree = seed % 7 == 3;
  }

  SceneText make() {
    scene_.samples = plan_.samples;
    scene_.each(plan_.ours, plan_.mitsubas);
    choose_lights();
    const CameraLimits limits{
        .unit = unit_, .far_clip = !plan_.hides, .wide_filter = area_lights_ == 0 || plan_.hides};
    const std::string camera = random_camera(limits, random_);
    const char* sampler = random_.one_of({"independent", "stratified", "halton", "sobol", "ldsampler"});
    scene_.each(plugin("sensor", "perspective", camera + plugin("sampler", sampler, "")),
                plugin("sensor", "perspective", camera));
    add_materials();
    add_floor();
    add_lights();
    if (!plan_.open) {
      const int count = 1 + random_.below(4);
      for (int k = 0; k < count; ++k) {
        if (const auto place = free_place(random_.between(0.25, 0.55))) add_object(*place);
      }
    }
    return std::move(scene_);
  }

 private:
  // Materials -----------------------------------------------------------------------------------------------

  std::string colour(std::string_view name, double low, double high) {
    if (random_.chance(0.15)) {
      if (name == "radiance") scene_.colour_error = 4e-4;
      return element("spectrum", name, number_text(random_.between(low, high)));
    }
    if (random_.chance(0.15)) return element("rgb", name, number_text(random_.between(low, high)));
    return rgb(name, random_.vector(low, high));
  }

  std::string one_sided() {
    // The lobes are wide, so that no light path is rare.
    if (random_.chance(0.3)) {
      const double half = 0.5 * plan_.albedo;
      std::string phong =
          colour("diffuse_reflectance", 0.05, half) + colour("specular_reflectance", 0.05, half);
      if (random_.chance(0.8)) phong += real("exponent", std::exp(random_.between(0, 3.7)));
      return plugin("bsdf", "phong", phong);
    }
    if (plan_.albedo >= 0.5 && random_.chance(0.1)) return plugin("bsdf", "diffuse", "");
    return plugin("bsdf", "diffuse", colour("reflectance", 0.1, plan_.albedo));
  }

  std::string bsdf() {
    switch (random_.below(4)) {
      case 0:
        return one_sided();
      case 1:
        return plugin("bsdf", "twosided", one_sided() + one_sided());
      default:
        return plugin("bsdf", "twosided", one_sided());
    }
  }

  void add_materials() {
    for (int k = 0; k < 2; ++k) {
      std::string material = bsdf();
      material.insert(material.find('>'), fmt::format(" id=\"material-{}\"", k));
      scene_.both(material);
    }
  }

  std::string any_bsdf() {
    if (random_.chance(0.3)) return fmt::format("<ref id=\"material-{}\"/>\n", random_.below(2));
    if (plan_.albedo >= 0.5 && random_.chance(0.1)) return "";
    return bsdf();
  }

  // Shapes --------------------------------------------------------------------------------------------------

  /// Objects do not come closer to each other than a tenth of the scene: contacts are where offsets of rays
  /// show.
  std::optional<Ball> free_place(double radius) {
    for (int attempt = 0; attempt < 100; ++attempt) {
      const Ball ball{
          {random_.between(-1.3, 1.3), random_.between(-0.9 + radius, 1.4), random_.between(-1.3, 1.3)},
          radius};
      const bool free = std::ranges::all_of(taken_, [&](const Ball& other) {
        return glm::distance(ball.center, other.center) > ball.radius + other.radius + 0.1;
      });
      if (!free) continue;
      taken_.push_back(ball);
      return ball;
    }
    return std::nullopt;
  }

  /// Places what fits into a sphere of radius `reach` about the origin into the ball.
  std::string placement(const Ball& ball, double reach, Freedom freedom, bool mirror_allowed) {
    const double size = ball.radius / reach * unit_;
    glm::dvec3 factors(size);
    if (freedom == Freedom::kAny && random_.chance(0.5)) factors *= random_.vector(0.5, 1.0);
    if (freedom == Freedom::kDisk && random_.chance(0.5)) factors.z = random_.between(0.2, 3) * unit_;
    if (mirror_allowed && random_.chance(0.35)) factors[random_.below(3)] *= -1;
    // Mitsuba wants an axis of length 1.
    const glm::dvec3 axis = glm::normalize(random_.vector(-1, 1) + glm::dvec3(0, 0, 1.1)),
                     center = ball.center * unit_;
    const double angle = random_.between(-180, 180);
    if (random_.chance(0.7)) {
      return fmt::format("<scale value=\"{}\"/>\n<rotate value=\"{}\" angle=\"{}\"/>\n", vector_text(factors),
                         vector_text(axis), number_text(angle)) +
             translate(center);
    }
    glm::dmat4 shear(1.0);
    if (freedom == Freedom::kAny) {
      shear[1][0] = random_.between(-0.3, 0.3);
      factors *= 0.8;
    }
    const glm::dmat4 m = translation(center) * rotation(axis, angle) * scaling(factors) * shear;
    std::string values;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) values += fmt::format("{:.9g} ", m[column][row]);
    return fmt::format("<matrix value=\"{}\"/>\n", values);
  }

  /// A shape of the type with a placement before what else is inside.
  void add_shape(std::string_view type, const std::string& inside) {
    scene_.both(plugin("shape", type, inside));
  }

  std::string flip() { return random_.chance(0.3) ? boolean("flip_normals", true) : ""; }

  /// A mesh as a file. Mitsuba's BSDF is in one that goes by the geometric normal where there are vertex
  /// normals, which without `face_normals` there always are.
  void add_mesh(const Polyhedron& mesh, bool concave, const std::string& inside, const std::string& bsdf,
                bool face_normals) {
    const std::string their_bsdf =
        face_normals ? bsdf : plugin("bsdf", "sides", bsdf.empty() ? plugin("bsdf", "diffuse", "") : bsdf);
    const std::string faces = face_normals ? boolean("face_normals", true) : "";
    const bool obj = random_.chance(0.5);
    const char* extension = obj ? "obj" : "ply";
    const std::string name = fmt::format("mesh-{}.{}", scene_.meshes.size(), extension);
    const bool triangles = !mesh.normals.empty(), from_end = obj && random_.chance(0.3);
    const auto file = [&](bool in_triangles, bool negative) {
      return obj ? obj_text(mesh, in_triangles, negative, random_.chance(0.3))
                 : ply_text(mesh, in_triangles, random_);
    };
    scene_.meshes.push_back({name, file(triangles, from_end)});
    // Mitsuba takes polygons for convex in OBJ, and reads triangles alone in PLY; nor does it read negative
    // indices.
    std::string their_name = name;
    if ((!triangles && (concave || !obj)) || from_end) {
      their_name = fmt::format("mesh-{}-for-mitsuba.{}", scene_.meshes.size(), extension);
      scene_.meshes.push_back({their_name, file(true, false)});
    }
    scene_.each(plugin("shape", extension, text("filename", name) + inside + faces + bsdf),
                plugin("shape", extension, text("filename", their_name) + inside + faces + their_bsdf));
  }

  void add_object(const Ball& place) {
    const double sqrt2 = std::sqrt(2.0), sqrt3 = std::sqrt(3.0);
    // What Mitsuba sees of disks and spheres through hidden lights is unlit.
    const int kind = plan_.hides ? random_.one_of({0, 1, 4, 5, 6, 7}) : random_.below(8);
    // Flat and open shapes are seen from both sides.
    if (kind == 0)
      return add_shape("rectangle",
                       to_world(placement(place, sqrt2, Freedom::kAny, true)) + flip() + any_bsdf());
    if (kind == 1)
      return add_shape("cube", to_world(placement(place, sqrt3, Freedom::kAny, true)) + flip() + any_bsdf());
    if (kind == 2)
      return add_shape("disk", to_world(placement(place, 1, Freedom::kDisk, true)) + flip() + any_bsdf());
    if (kind == 3) return add_sphere(place, flip() + any_bsdf());
    std::string inside = to_world(placement(place, 1, Freedom::kAny, true)) + flip();
    if (random_.chance(0.2)) inside += boolean("flip_tex_coords", random_.chance(0.5));
    // How normals change over a concave face is a question of its triangles.
    const bool concave = kind >= 6 && random_.chance(0.5), face_normals = concave || random_.chance(0.4);
    add_mesh(kind == 4   ? ball(6, 10, random_.one_of({1.0, 0.6}))
             : kind == 5 ? ring(8, 12)
             : concave   ? concave_mesh()
                         : convex_faces(),
             concave, inside, any_bsdf(), face_normals);
  }

  Polyhedron concave_mesh() {
    return random_.chance(0.5) ? star(3 + random_.below(4)) : star_prism(3 + random_.below(3));
  }

  Polyhedron convex_faces() {
    switch (random_.below(4)) {
      case 0:
        return tetrahedron();
      case 1:
        return faceted(ball(4, 7, 1));
      case 2:
        return faceted(ring(5, 7));
      default:
        return plate(3 + random_.below(6));
    }
  }

  void add_sphere(const Ball& place, const std::string& inside) {
    if (random_.chance(0.5))
      return add_shape("sphere", to_world(placement(place, 1, Freedom::kSphere, true)) + inside);
    const std::string center = element("point", "center", vector_text(place.center * unit_));
    add_shape("sphere", center + real("radius", place.radius * unit_) + inside);
  }

  void add_floor() {
    std::string steps =
        fmt::format("<scale value=\"{}\"/>\n<rotate x=\"1\" angle=\"-90\"/>\n", number_text(2.5 * unit_)) +
        translate(glm::dvec3(0, -1, 0) * unit_);
    const char* type = plan_.hides ? "rectangle" : random_.one_of({"rectangle", "rectangle", "disk"});
    const std::string material = plugin("bsdf", "twosided", one_sided());
    if (random_.chance(0.2)) {
      add_mesh(plate(4 + random_.below(4)), false, to_world(steps), material, true);
    } else {
      add_shape(type, to_world(steps) + material);
    }
    if (!plan_.open && random_.chance(0.4)) {
      steps = fmt::format("<scale value=\"{}\"/>\n", number_text(2.5 * unit_)) +
              translate(glm::dvec3(0, 0, -2) * unit_);
      add_shape("rectangle", to_world(steps) + any_bsdf());
    }
  }

  // Lights --------------------------------------------------------------------------------------------------

  void choose_lights() {
    sky_ = plan_.sky && random_.chance(0.3);
    point_ = plan_.point_lights && random_.chance(0.3);
    area_lights_ = plan_.open ? 1 : random_.below(3);
    if (!sky_ && !point_) area_lights_ = std::max(area_lights_, 1);
  }

  void add_lights() {
    for (int k = 0; k < area_lights_; ++k) {
      const double radius = random_.between(plan_.area_light_radius, plan_.area_light_radius + 0.25);
      if (const auto place = free_place(radius)) add_area_light(*place);
    }
    if (sky_) scene_.both(plugin("emitter", "constant", colour("radiance", 0.2, 0.8)));
    if (point_) add_point();
    if (plan_.point_lights && beams_.chance(0.35)) add_beam();
  }

  void add_point() {
    const auto place = free_place(0.15);
    if (!place) return;
    const glm::dvec3 at = place->center * unit_;
    const std::string where =
        random_.chance(0.5) ? element("point", "position", vector_text(at)) : to_world(translate(at));
    scene_.both(plugin("emitter", "point", where + rgb("intensity", random_.vector(1, 3) * unit_ * unit_)));
  }

  /// A spot light, a projector or a directional light, by numbers of its own.
  void add_beam() {
    const glm::dvec3 eye = beams_.vector(-1.5, 1.5) + glm::dvec3(0, 3, 0), target = beams_.vector(-0.6, 0.6);
    const std::string colour = rgb("COLOUR", beams_.vector(1, 4) * unit_ * unit_);
    const auto named = [&](const char* name) {
      std::string text = colour;
      return text.replace(text.find("COLOUR"), 6, name);
    };
    const std::string place = look_at(eye * unit_, target * unit_);
    const int kind = beams_.below(3);
    const double cutoff = beams_.between(20, 80);
    if (kind == 0)
      scene_.both(plugin("emitter", "spot",
                         named("intensity") + real("cutoff_angle", cutoff) +
                             real("beam_width", beams_.between(0, 0.95) * cutoff) + place));
    if (kind == 1)
      scene_.both(plugin("emitter", "projector", named("irradiance") + real("fov", 1.5 * cutoff) + place));
    if (kind == 2)
      scene_.both(plugin("emitter", "directional", rgb("irradiance", beams_.vector(0.1, 1)) + place));
  }

  void add_area_light(const Ball& place) {
    const std::string radiance = colour("radiance", 1, 5);
    std::string sampling;
    if (random_.chance(0.3))
      sampling = text("sampling", random_.one_of({"auto", "area", "solid_angle", "projected"}));
    const int kind = random_.below(plan_.quadric_lights ? 7 : 5);
    // Both of the two that stand for a two-sided one in Mitsuba must reflect as it does.
    const bool two_sided = kind < 2 && random_.chance(0.4);
    const std::string material = random_.chance(0.2) ? ""
                                 : two_sided         ? plugin("bsdf", "twosided", one_sided())
                                                     : bsdf();
    // What shines inwards, out of sight, Mitsuba lets through at the edges.
    const bool closed = kind == 2 || kind == 3 || kind == 6;
    const std::string flipped = closed ? "" : flip();
    const std::string ours =
        flipped + material +
        plugin("emitter", "area", radiance + sampling + (two_sided ? boolean("two_sided", true) : ""));
    const std::string theirs = flipped + material + plugin("emitter", "area", radiance);
    const double reach = kind == 0 ? std::sqrt(2.0) : kind == 2 ? std::sqrt(3.0) : 1;
    const Freedom freedom = kind == 5 ? Freedom::kDisk : kind == 6 ? Freedom::kSphere : Freedom::kAny;
    const std::string steps = placement(place, reach, freedom, !two_sided && !closed);
    if (kind == 3) return add_area_light_mesh(tetrahedron(), steps, ours, theirs);
    if (kind == 1 || kind == 4) {
      const Polyhedron flat =
          kind == 1 || plan_.open ? plate(3 + random_.below(5)) : star(3 + random_.below(3));
      if (!two_sided) return add_area_light_mesh(flat, steps, ours, theirs);
      const std::string name = fmt::format("mesh-{}.obj", scene_.meshes.size());
      scene_.meshes.push_back({name, obj_text(flat, true)});
      return add_two_sided("obj", text("filename", name) + boolean("face_normals", true), steps, ours,
                           radiance, material, !flipped.empty());
    }
    static constexpr const char* kTypes[] = {"rectangle", "", "cube", "", "", "disk", "sphere"};
    if (two_sided) return add_two_sided(kTypes[kind], "", steps, ours, radiance, material, !flipped.empty());
    scene_.each(plugin("shape", kTypes[kind], to_world(steps) + ours),
                plugin("shape", kTypes[kind], to_world(steps) + theirs));
  }

  void add_area_light_mesh(const Polyhedron& mesh, const std::string& steps, const std::string& ours,
                           const std::string& theirs) {
    // No vertex normals: Mitsuba takes the cosine at a light from them, so that its samples of lights and of
    // BSDFs mean different lights.
    const std::string name = fmt::format("mesh-{}.ply", scene_.meshes.size());
    scene_.meshes.push_back({name, ply_text(mesh, true, random_)});
    const std::string inside = text("filename", name) + to_world(steps) + boolean("face_normals", true);
    scene_.each(plugin("shape", "ply", inside + ours), plugin("shape", "ply", inside + theirs));
  }

  /// Mitsuba's are two flat lights back to back, a ten-thousandth of their size apart.
  void add_two_sided(std::string_view type, const std::string& file, const std::string& steps,
                     const std::string& ours, const std::string& radiance, const std::string& material,
                     bool flipped) {
    const std::string light = material + plugin("emitter", "area", radiance);
    const std::string apart = translate({0, 0, flipped ? 1e-4 : -1e-4});
    scene_.each(plugin("shape", type, file + to_world(steps) + ours),
                plugin("shape", type, file + to_world(steps) + boolean("flip_normals", flipped) + light) +
                    plugin("shape", type,
                           file + to_world(apart + steps) + boolean("flip_normals", !flipped) + light));
  }

  Random random_;
  Random beams_;
  double unit_;  ///< of length
  IntegratorPlan plan_;
  bool sky_ = false, point_ = false;
  int area_lights_ = 0;
  SceneText scene_;
  std::vector<Ball> taken_;
};

}  // namespace

SceneText random_scene(std::uint32_t seed) { return Generator(seed).make(); }

}  // namespace penumbra::differential
