// Whole renders: furnaces, glossy floors, extreme images, many samples.
#include <fmt/format.h>

#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/cases/scene_pieces.h"
#include "scheduler/stress/truth/polygon.h"

namespace penumbra::stress {
namespace render_cases {
namespace {

/// The six sides of the cube (-1, 1)^3 seen from inside; without `open` ones.
void add_room(SceneDescription& scene, int bsdf, std::optional<float> radiance, bool open) {
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 u(0), v(0), out(0);
    u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2;
    for (const int side : {-1, 1}) {
      if (open && axis == 2 && side == 1) continue;
      out[axis] = side;
      const glm::dvec3 corner = out - .5 * (u + v);
      scene.shapes.push_back(side < 0 ? quad_shape(corner, u, v, bsdf, radiance)
                                      : quad_shape(corner, v, u, bsdf, radiance));
    }
  }
}

void add_furnaces(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    float albedo;
    int depth;
  };
  const Entry entries[] = {{"albedo-.99", "64 bounces of albedo .99", .99f, 64},
                           {"albedo-1", "256 bounces of albedo 1", 1, 256}};
  for (const Entry& e : entries)
    cases.push_back({fmt::format("furnace/{}", e.name),
                     e.stiff,
                     "radiance in a closed room that emits 1",
                     RenderMeasurement{[e] {
                                         SceneDescription scene = empty_scene(1, 1, 256, {}, {.3, .2, 1}, 10);
                                         add_room(scene, add_diffuse(scene, e.albedo), 1.f, false);
                                         scene.integrator = path(e.depth);
                                         return scene;
                                       },
                                       first_pixel},
                     {[e] {
                        Quad sum = 0, power = 1;
                        for (int k = 0; k < e.depth; ++k, power *= e.albedo) sum += power;
                        return Quads{sum};
                      },
                      "geometric series in 113 bits"},
                     relative(2 * e.depth * kUlp, "a product and a sum are rounded at each bounce")});
  cases.push_back({"furnace/open-albedo-1", "unlimited bounces of albedo 1 in a white sky",
                   "radiance in an open box",
                   RenderMeasurement{[] {
                                       SceneDescription scene = empty_scene(1, 1, 1024, {}, {.3, .2, -1}, 10);
                                       add_room(scene, add_diffuse(scene, 1), {}, true);
                                       scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
                                       scene.integrator = path(-1);
                                       return scene;
                                     },
                                     first_pixel},
                   known(1, "every path ends in the sky"), relative(8 * kUlp, "weights of exactly 1")});
}

void add_glossy(std::vector<Case>& cases) {
  for (const auto& [name, exponent] :
       {std::pair("0", 0), std::pair("100", 100), std::pair("1e4", 10000), std::pair("1e5", 100000)}) {
    const int e = exponent;
    for (const bool closed_form : {true, false}) {
      const std::uint32_t spp = closed_form ? 4 : 1 << 16;
      // The camera is where the floor's mirror direction meets the light, off its middle.
      const glm::dvec3 camera(-.6, -.3, 1.5);
      const Quad3 w = normalize({.6, .3, 1.5});
      cases.push_back(
          {fmt::format("glossy/{}-{}", name, closed_form ? "analytic" : "samples"),
           fmt::format("a Phong floor of exponent {}, {}", name,
                       closed_form ? "closed form" : "both kinds of samples"),
           "radiance of a floor that mirrors a square light",
           RenderMeasurement{
               [=] {
                 SceneDescription scene = empty_scene(1, 1, spp, camera, {0, 0, 0}, 1e-6);
                 const int glossy = add_phong(scene, .8f, float(e));
                 scene.shapes.push_back(quad_shape({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, glossy, {}));
                 scene.shapes.push_back(quad_shape({-.2, -.5, 1}, {0, 1, 0}, {1, 0, 0}, kBlackBsdf, 3));
                 scene.integrator = closed_form ? analytic() : both_samples();
                 return scene;
               },
               first_pixel},
           {[e, w] {
              const Loop loop{
                  {-Quad(1) / 5, -.5, 1}, {-Quad(1) / 5, .5, 1}, {Quad(4) / 5, .5, 1}, {Quad(4) / 5, -.5, 1}};
              return Quads{3 * Quad(.8f) * lobe({loop}, {}, {0, 0, 1}, w, e)};
            },
            "Arvo's recurrence for clipped triangles in 113 bits"},
           closed_form
               ? Allowed{3e-10,
                         64 * kUlp + 8 * kUlp * std::sqrt(double(e)),
                         "rounding of a direction, over the lobe's width; documented error of the lobe",
                         {}}  // Balanced, each of two samples is at most 3 (e + 2) / (e + 1) times .8.
               : absolute(5 * 3 * .8 * (e + 2.0) / (e + 1.0) / std::sqrt(double(spp)),
                          "5 deviations of samples in a range of twice the radiance")});
    }
  }
}

void add_images(std::vector<Case>& cases) {
  struct Size {
    const char* name;
    int width, height;
  };
  for (const Size& size : {Size{"1x1", 1, 1}, Size{"32768x1", 32768, 1}, Size{"1x32768", 1, 32768}}) {
    cases.push_back(
        {fmt::format("image/{}-sky", size.name), "an image of extreme size",
         "mean of all pixels that see a sky of 1",
         RenderMeasurement{
             [size] {
               SceneDescription scene = empty_scene(size.width, size.height, 4, {}, {0, 0, 1}, 90);
               scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
               scene.integrator = path(2);
               return scene;
             },
             [](const FilmAccumulator& film) {
               double sum = 0;
               for (int y = 0; y < film.height(); ++y)
                 for (int x = 0; x < film.width(); ++x) sum += film.at(x, y).mean[0];
               return Numbers{sum / (double(film.width()) * film.height())};
             }},
         known(1, "closed form"), absolute(0, "every sample is 1")});
  }
  cases.push_back({"image/32768x1-half",
                   "an edge between two of 32768 pixels",
                   "pixels on the left, and on the right, that are lit",
                   RenderMeasurement{[] {
                                       SceneDescription scene = empty_scene(32768, 1, 16, {}, {0, 0, 1}, 90);
                                       scene.shapes.push_back(quad_shape({0, -1, 1}, {0, 2, 0}, {3, 0, 0},
                                                                         kBlackBsdf,
                                                                         1));  // camera's left is +x
                                       scene.integrator = path(1);
                                       return scene;
                                     },
                                     [](const FilmAccumulator& film) {
                                       double left = 0, right = 0;
                                       for (int x = 0; x < 32768; ++x)
                                         (x < 16384 ? left : right) += film.at(x, 0).mean[0];
                                       return Numbers{left, right};
                                     }},
                   {[] {
                      return Quads{16384, 0};
                    },
                    "closed form"},
                   absolute(0, "the edge is on a pixel's border")});
  for (const auto& [name, integrator] : {std::pair("path", path(-1)), std::pair("direct", both_samples()),
                                         std::pair("analytic", analytic())}) {
    const IntegratorSettings settings = integrator;
    cases.push_back({fmt::format("image/empty-{}", name), "a scene without anything in it", "radiance",
                     RenderMeasurement{[settings] {
                                         SceneDescription scene = empty_scene(4, 4, 16, {}, {0, 0, 1}, 40);
                                         scene.integrator = settings;
                                         return scene;
                                       },
                                       first_pixel},
                     known(0, "by definition"), absolute(0, "nothing is there")});
  }
  for (const auto& [name, cosine] : {std::pair("1e-3", 1e-3), std::pair("1e-6", 1e-6)}) {
    const double c = cosine;
    cases.push_back(
        {fmt::format("image/grazing-{}", name), fmt::format("a floor seen under a cosine of {}", name),
         "radiance of a floor of albedo .5 in a sky of 1",
         RenderMeasurement{[c] {
                             SceneDescription scene = empty_scene(1, 1, 1024, {-1, 0, c}, {0, 0, 0}, 1e-9);
                             const int grey = add_diffuse(scene, .5f);
                             scene.shapes.push_back(quad_shape({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, grey, {}));
                             scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
                             scene.integrator = path(2);
                             return scene;
                           },
                           first_pixel},
         known(Quad(.5), "furnace"), absolute(0, "every sample is the albedo")});
  }
}

/// A pixel of which a light covers .3: every sample is 0 or 1.
SceneDescription covered_pixel() {
  SceneDescription scene = empty_scene(1, 1, 100'000'000, {}, {0, 0, 1}, 90);
  scene.shapes.push_back(quad_shape({.4, -2, 1}, {0, 4, 0}, {3, 0, 0}, kBlackBsdf, 1));
  scene.integrator = path(1);
  return scene;
}

void add_many_samples(std::vector<Case>& cases) {
  const double count = 1e8, share = .3;
  cases.push_back({"samples/1e8-mean", "1e8 samples of one pixel in 24415 passes",
                   "share of samples that see a light",
                   RenderMeasurement{covered_pixel, first_pixel, 0, false}, known(Quad(3) / 10, "area"),
                   absolute(5 * std::sqrt(share * (1 - share) / count) + 4 * kUlp,
                            "5 deviations of 1e8 samples; rounding of the edge's place")});
}

}  // namespace

void add(std::vector<Case>& cases) {
  add_furnaces(cases);
  add_glossy(cases);
  add_images(cases);
  add_many_samples(cases);
}

}  // namespace render_cases

void add_render_cases(std::vector<Case>& cases) { render_cases::add(cases); }

}  // namespace penumbra::stress
