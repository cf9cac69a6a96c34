#include "tests/differential/random_settings.h"

#include <algorithm>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {
namespace {

class Integrators {
 public:
  explicit Integrators(Random& random) : random_(random) {}

  IntegratorPlan make(int kind) {
    choose(kind);
    return plan_;
  }

 private:
  std::string hide() {
    plan_.hides = random_.chance(0.15);
    return plan_.hides ? boolean("hide_emitters", true) : "";
  }
  std::string emitter_sampling() {
    return random_.chance(0.3)
               ? ""
               : text("emitter_sampling", random_.one_of({"auto", "area", "solid_angle", "projected"}));
  }
  std::string heuristic() {
    return random_.chance(0.5) ? "" : text("mis", random_.one_of({"balance", "power"}));
  }
  /// By the unshadowed contribution only where lights alone are sampled.
  std::string light_choice(bool lights_alone) {
    if (random_.chance(0.5)) return "";
    return text("light_choice", lights_alone ? random_.one_of({"auto", "power", "analytic"})
                                             : random_.one_of({"auto", "power"}));
  }

  /// Length and roulette of paths, the same for both.
  std::string depth() {
    if (random_.chance(0.15)) {
      plan_.albedo = 0.5;
      return integer("max_depth", -1) + integer("rr_depth", 3 + random_.below(3));
    }
    return integer("max_depth", 1 + (random_.chance(0.95) ? 1 + random_.below(3) : 0)) + hide();
  }

  void path(std::string_view type, const std::string& settings) {
    const std::string depths = depth();
    plan_.ours = plugin("integrator", type, depths + settings);
    plan_.mitsubas = plugin("integrator", "path", depths);
  }

  void direct() {
    const int emitter_samples = random_.below(4),
              bsdf_samples = emitter_samples == 0 ? 1 + random_.below(3) : random_.below(3);
    const std::string hidden = hide();
    std::string numbers = integer("emitter_samples", emitter_samples) + integer("bsdf_samples", bsdf_samples);
    if (bsdf_samples > 0 && emitter_samples > 0 && random_.chance(0.3))
      numbers = integer("shading_samples", 1 + random_.below(3));
    std::string ours = numbers + hidden + emitter_sampling() + heuristic() + light_choice(bsdf_samples == 0);
    if (random_.chance(0.6)) ours += text("bsdf_sampling", random_.one_of({"bsdf", "cosine", "uniform"}));
    plan_.ours = plugin("integrator", "direct", ours);
    // Mitsuba counts a point light once for each sample, however many there are.
    const std::string theirs = integer("emitter_samples", std::min(emitter_samples, 1)) +
                               integer("bsdf_samples", std::min(bsdf_samples, 1));
    plan_.mitsubas = plugin("integrator", "direct", theirs + hidden);
    if (emitter_samples == 0) plan_.area_light_radius = 0.4, plan_.samples = 2;
  }

  /// Direct light of polygon lights.
  void polygons(std::string_view type, const std::string& settings) {
    const std::string hidden = hide();
    plan_.ours = plugin("integrator", type, settings + hidden);
    plan_.mitsubas = plugin("integrator", "direct", hidden);
    plan_.point_lights = plan_.sky = plan_.quadric_lights = false;
  }

  void choose(int kind) {
    const std::string samples = integer("emitter_samples", 1 + random_.below(4));
    switch (kind) {
      case 0:
      case 1:
      case 2:
        return path("path", emitter_sampling() + heuristic() + light_choice(false));
      case 3:
        if (random_.chance(0.5)) return path("path_mis", emitter_sampling());
        return path("path", text("direct_sampling", "ems") + emitter_sampling());
      case 4:
        // Point lights are found by samples of emitters alone, which Mitsuba's path always takes.
        plan_.point_lights = false;
        plan_.area_light_radius = 0.4;
        plan_.samples = 4;
        if (random_.chance(0.5)) return path("path_mats", "");
        return path("path", text("direct_sampling", "mats"));
      case 5:
        return path("path_ems", emitter_sampling() + light_choice(true));
      case 6: {
        const std::string alpha =
            random_.chance(0.5) ? text("alpha", "auto") : real("alpha", random_.one_of({0.0, 0.5, 1.0}));
        return path("path", text("nee", "cv") + alpha + emitter_sampling() + light_choice(false));
      }
      case 9:
        return polygons("polygon_area", samples + emitter_sampling() + light_choice(true));
      case 10: {
        const std::string alpha =
            random_.chance(0.5) ? text("alpha", "auto") : real("alpha", random_.one_of({0.0, 0.5, 1.0}));
        return polygons("polygon_cv", integer("vis_samples", 1 + random_.below(3)) + alpha +
                                          emitter_sampling() + light_choice(true));
      }
      case 11:
        // Without shadows: Mitsuba can only say what a scene is like where there are none.
        plan_.open = true;
        if (random_.chance(0.5)) return polygons("polygon_analytic", "");
        return polygons("polygon_area", boolean("trace_shadows", false) + samples + emitter_sampling());
      default:
        return direct();
    }
  }

  Random& random_;
  IntegratorPlan plan_;
};

std::string random_film(bool wide_filter, Random& random) {
  // Mitsuba draws each sample into all pixels that its filter reaches; where it also takes samples beyond
  // the border, each pixel's expectation is that of samples drawn from the filter, but for the error of a
  // quotient of two sums over some hundred samples, which has opposite signs on both sides of an edge.
  std::string result = boolean("sample_border", true);
  const int width = 6 * (3 + random.below(3)), height = 6 * (3 + random.below(3));
  if (random.chance(0.25)) {
    const int left = random.below(9), top = random.below(9);
    result += integer("width", width + left + random.below(9)) +
              integer("height", height + top + random.below(9)) + integer("crop_offset_x", left) +
              integer("crop_offset_y", top) + integer("crop_width", width) + integer("crop_height", height);
  } else {
    result += integer("width", width) + integer("height", height);
  }
  if (wide_filter && random.chance(0.1)) return plugin("film", "hdrfilm", result);  // a Gaussian
  const char* filter = wide_filter ? random.one_of({"box", "tent", "gaussian", "mitchell"}) : "box";
  std::string settings;
  if (filter == std::string_view("tent") && random.chance(0.5))
    settings = real("radius", random.between(0.7, 1.6));
  if (filter == std::string_view("gaussian") && random.chance(0.5))
    settings = real("stddev", random.between(0.3, 0.7));
  if (filter == std::string_view("mitchell") && random.chance(0.5))
    settings = "<float name=\"B\" value=\"0.5\"/>\n<float name=\"C\" value=\"0.25\"/>\n";
  result += plugin("rfilter", filter, settings);
  return plugin("film", "hdrfilm", result);
}

}  // namespace

IntegratorPlan plan_integrator(int kind, Random& random) { return Integrators(random).make(kind); }

std::string random_camera(const CameraLimits& limits, Random& random) {
  const double unit = limits.unit;
  std::string sensor;
  if (random.chance(0.15)) {
    sensor += text("focal_length", random.one_of({"35mm", "50mm", "60"}));
  } else {
    sensor += real("fov", random.between(30, 50));
    if (random.chance(0.7))
      sensor += text("fov_axis", random.one_of({"x", "y", "diagonal", "smaller", "larger"}));
  }
  const double x = random.between(-2, 2), y = random.between(-0.5, 2.5), z = random.between(4, 5);
  const glm::dvec3 eye(x, y, z);
  const glm::dvec3 target = random.vector(-0.2, 0.2);
  if (random.chance(0.2)) {
    // A mirror image.
    sensor +=
        to_world(fmt::format("<scale x=\"-1\"/>\n<lookat origin=\"{}\" target=\"{}\" up=\"0.1, 1, 0\"/>\n",
                             vector_text(eye * unit), vector_text(target * unit)));
  } else {
    sensor += look_at(eye * unit, target * unit);
  }
  const double distance = glm::length(eye);
  sensor += real("near_clip", unit * (random.chance(0.1) ? distance - 0.3 : 0.01));
  sensor += real("far_clip", unit * (limits.far_clip && random.chance(0.1) ? distance + 0.3 : 1000.0));
  return sensor + random_film(limits.wide_filter, random);
}

}  // namespace penumbra::differential
