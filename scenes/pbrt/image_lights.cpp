#include "scenes/pbrt/image_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "scenes/angles.h"
#include "scenes/image/bitmap_values.h"
#include "scenes/names.h"
#include "scenes/pbrt/light_strength.h"
#include "scenes/punctual_lights.h"
#include "scenes/transform.h"

namespace penumbra::pbrt {
namespace {

/// The illuminance of a plane below the octahedral image, as pbrt computes it, because files give a sky's
/// brightness accordingly. It is half of the true value. Also, pbrt takes channels in the order of the file,
/// in which those of EXR files are B, G, R.
double illuminance_of(const Bitmap& square, const std::string& file) {
  const BitmapValues values(square, kSrgb);
  const bool blue_first = extension_of(file) == ".exr";
  const auto channels = std::size_t(square.channels);
  double sum = 0;
  for (int y = 0; y < square.height; ++y)
    for (int x = 0; x < square.width; ++x) {
      // The central diamond is the upper hemisphere. Areas there are proportional to solid angle, and z = 1 -
      // r².
      const double r =
          std::abs(2 * (x + 0.5) / square.width - 1) + std::abs(2 * (y + 0.5) / square.height - 1);
      if (r >= 1) continue;
      const std::size_t at = (std::size_t(y) * std::size_t(square.width) + std::size_t(x)) * channels;
      const auto value = [&](std::size_t c) { return double(values[at + std::min(c, channels - 1)]); };
      const glm::dvec3 colour(value(0), value(1), value(2));
      sum += (1 - r * r) * luminance(blue_first ? glm::dvec3(colour.z, colour.y, colour.x) : colour);
    }
  return sum * 2 * kPi / (double(square.width) * square.height);
}

/// An octahedral image. As in pbrt, a direction has the colour of its texel.
class OctahedralImage {
 public:
  explicit OctahedralImage(const Bitmap& square) : values_(square, kSrgb), square_(square) {}

  [[nodiscard]] glm::dvec3 towards(const glm::dvec3& direction) const {
    const int side = square_.width;
    const glm::dvec2 at = octahedral_square(direction) * double(side);
    const int x = std::clamp(int(at.x), 0, side - 1), y = std::clamp(int(at.y), 0, side - 1);
    const auto channels = std::size_t(square_.channels);
    const std::size_t first = (std::size_t(y) * std::size_t(side) + std::size_t(x)) * channels;
    const auto value = [&](std::size_t c) { return double(values_[first + std::min(c, channels - 1)]); };
    return {value(0), value(1), value(2)};
  }

 private:
  BitmapValues values_;
  const Bitmap& square_;
};

void add(std::vector<float>& values, const glm::dvec3& colour) {
  for (int c = 0; c < 3; ++c) values.push_back(float(colour[c]));
}

/// Resamples the octahedral image to longitude and polar angle, with y up and half as many rows as columns.
/// A small image gets more texels than it has: its own have sharp edges, ours are interpolated.
std::shared_ptr<const Bitmap> resampled(const Context& context, const Bitmap& square) {
  const int finer = std::max(square.width, std::min(8 * square.width, 1024));
  const int height = std::clamp(finer, 2, 8192), width = 2 * height;
  const OctahedralImage image(square);
  std::vector<float> values;
  values.reserve(3 * std::size_t(width) * std::size_t(height));
  for (int row = 0; row < height; ++row) {
    const double theta = kPi * row / (height - 1);
    for (int column = 0; column < width; ++column) {
      // Our texel (x, y) is at longitude 2 pi (x + 1/2) / W, see kernels/light/envmap_grid.h; z becomes -y.
      const double phi = 2 * kPi * (column + 0.5) / width;
      const glm::dvec3 from(std::sin(phi) * std::sin(theta), std::cos(theta),
                            -std::cos(phi) * std::sin(theta));
      add(values, balanced(context, image.towards(from)));
    }
  }
  return std::make_shared<const Bitmap>(float_bitmap(square.name, width, height, 3, values));
}

/// The radiant intensity of a beam as an image of `width` by `height`. `half` is the tangent of half the
/// angle of its shorter side. It is computed from a function of positions at distance 1.
struct Beam {
  int width = 0, height = 0;
  double half = 1.0;
  std::vector<float> values = {};
  double power = 0.0;  ///< luminance integrated over all directions, for unit scale
};
template <typename Intensity>
Beam beam_of(int width, int height, double half, const Intensity& intensity) {
  Beam beam{width, height, half};
  const double aspect = double(width) / height;
  const glm::dvec2 most = half * glm::dvec2(std::max(aspect, 1.0), std::max(1.0 / aspect, 1.0));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec3 at(most.x * (2 * (x + 0.5) / width - 1), -most.y * (2 * (y + 0.5) / height - 1), 1.0);
      // A projector's image is the irradiance on a plane at distance 1, which is cos³ times the intensity.
      const double cosine = 1 / glm::length(at), factor = cosine * cosine * cosine;
      const glm::dvec3 colour = factor * intensity(x, y, at);
      add(beam.values, colour);
      beam.power += luminance(colour) * 4 * most.x * most.y / (double(width) * height);
    }
  return beam;
}

/// Adds a beam. Its x axis points to the right of the image.
void add_beam(Context& context, TextureReader& textures, const std::string& name, const Beam& beam,
              const glm::dvec3& strength, const glm::dmat4& to_world, SourceLocation location) {
  const auto frame = without_scale(to_world * scaling(glm::dvec3(-1.0, 1.0, 1.0)));
  if (!frame) return context.report.error(location, frame.error().message);
  ProjectorLight light;
  light.irradiance = TexturedColour(glm::vec3(1.0f));
  // Divided by pi, because the image is the radiance of a white surface.
  light.irradiance.texture =
      textures.scaled(textures.made_image(name, float_bitmap(name, beam.width, beam.height, 3, beam.values)),
                      glm::vec3(strength / kPi));
  light.fov = 2 * std::atan(beam.half) / kDegree;
  light.fov_axis = FovAxis::kSmaller;
  light.to_world = *frame;
  context.scene.emitters.emplace_back(std::move(light));
}

}  // namespace

glm::dvec2 octahedral_square(glm::dvec3 direction) {
  const glm::dvec3 d = glm::abs(direction) / glm::length(direction);
  const double r = std::sqrt(std::max(1.0 - d.z, 0.0));
  const double phi = d.x == 0.0 && d.y == 0.0 ? 0.0 : std::atan2(d.y, d.x) * 2 / kPi;
  double v = phi * r, u = r - v;
  if (direction.z < 0.0) {
    std::swap(u, v);
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return {0.5 * (std::copysign(u, direction.x) + 1.0), 0.5 * (std::copysign(v, direction.y) + 1.0)};
}

void read_infinite(Context& context, TextureReader& textures, Parameters& parameters,
                   const GraphicsState& state, SourceLocation location) {
  ReaderReport& report = context.report;
  const auto other = std::ranges::find_if(context.scene.emitters, is_sky);
  const std::string file = parameters.text("filename", "", report);
  refuse_colour_of_image(context, parameters, "L");
  glm::vec3 radiance = emitted(context, parameters, "L", location);
  if (parameters.has("portal")) {
    parameters.take("portal");
    report.warn(parameters.location("portal", location),
                "portals are ignored: the light comes from everywhere");
  }
  auto* constant =
      other != context.scene.emitters.end() ? std::get_if<ConstantEnvironment>(&*other) : nullptr;
  if (other != context.scene.emitters.end() && (constant == nullptr || !file.empty())) {
    parameters.accept({"illuminance", "filename"});
    return report.unsupported(location,
                              "a second infinite light is not read, unless both are the same everywhere",
                              "it is left out");
  }
  if (constant != nullptr) {
    constant->radiance += radiance * float(factor_of(context, parameters, "illuminance", kPi));
    return;
  }
  if (file.empty()) {
    radiance *= float(factor_of(context, parameters, "illuminance", kPi));
    context.scene.emitters.emplace_back(ConstantEnvironment{radiance});
    return;
  }
  const auto image = textures.image(file, parameters.location("filename", location));
  if (image == nullptr) {
    context.scene.emitters.emplace_back(ConstantEnvironment{kUnreadColour});
    return;
  }
  if (image->width != image->height || image->width > 16384)
    return report.error(parameters.location("filename", location),
                        fmt::format("an image of {} x {}; one of all directions is square, up to 16384",
                                    image->width, image->height));
  report.warn_counted(location, "images of all directions are resampled, from octahedral to longitudes");
  EnvironmentMapLight sky;
  sky.filename = file;
  sky.image = resampled(context, *image);
  sky.scale = float(emitted_scale(context, parameters, location) *
                    factor_of(context, parameters, "illuminance", illuminance_of(*image, file)));
  sky.to_world = glm::dmat4(glm::dmat3(state.ctm.start));
  context.scene.emitters.emplace_back(std::move(sky));
}

void read_projection(Context& context, TextureReader& textures, Parameters& parameters,
                     const GraphicsState& state, SourceLocation location) {
  ReaderReport& report = context.report;
  const std::string file = parameters.text("filename", "", report);
  const double fov = parameters.number("fov", 90.0, report);
  const double strength = emitted_scale(context, parameters, location);
  if (!(fov > 0.0 && fov < 180.0))
    return report.error(parameters.location("fov", location),
                        fmt::format("fov must be between 0 and 180, not {}", fov));
  if (file.empty()) return report.error(location, "a projection light needs a \"string filename\"");
  const auto image = textures.image(file, parameters.location("filename", location));
  if (image == nullptr) return parameters.accept({"power"});
  const BitmapValues values(*image, kSrgb);
  const auto channels = std::size_t(image->channels);
  // Each texel of pbrt's image shines alike in all of its directions; ours are interpolated, so that a small
  // image gets more of them.
  const auto beam_of_texels = [&](int finer, const auto& shown) {
    return beam_of(finer * image->width, finer * image->height, std::tan(0.5 * fov * kDegree),
                   [&](int x, int y, const glm::dvec3&) {
                     const std::size_t texel =
                         std::size_t(y / finer) * std::size_t(image->width) + std::size_t(x / finer);
                     const auto value = [&](std::size_t c) {
                       return double(values[texel * channels + std::min(c, channels - 1)]);
                     };
                     return shown(glm::dvec3(value(0), value(1), value(2)));
                   });
  };
  const double power = beam_of_texels(1, std::identity()).power;
  const double factor = factor_of(context, parameters, "power", power > 0.0 ? power : 1.0);
  const int finer = std::max(1, 512 / std::max(image->width, image->height));
  const Beam beam =
      beam_of_texels(finer, [&](const glm::dvec3& colour) { return balanced(context, colour); });
  add_beam(context, textures, file, beam, glm::dvec3(factor * strength), state.ctm.start, location);
}

void read_goniometric(Context& context, TextureReader& textures, Parameters& parameters,
                      const GraphicsState& state, SourceLocation location) {
  ReaderReport& report = context.report;
  const std::string file = parameters.text("filename", "", report);
  glm::dvec3 strength(emitted(context, parameters, "I", location));
  if (file.empty()) {
    strength *= factor_of(context, parameters, "power", 4 * kPi);
    PunctualLight light;
    light.strength = glm::vec3(strength);
    light.position = transform_point(state.ctm.start, glm::dvec3(0.0));
    return add_punctual_light(light, context.scene);
  }
  const auto image = textures.image(file, parameters.location("filename", location));
  if (image == nullptr) return parameters.accept({"power"});
  if (image->width != image->height || image->width > 16384)
    return report.error(parameters.location("filename", location),
                        fmt::format("an image of {} x {}; one of all directions is square, up to 16384",
                                    image->width, image->height));
  // Areas of the octahedral image are proportional to solid angle. The colour is that of I, times the mean of
  // the image's channels.
  const Bitmap grey = channel_mean(*image, kSrgb);
  strength *= factor_of(context, parameters, "power", 4 * kPi * std::max(mean_luminance(grey), 1e-30));
  const OctahedralImage directions(grey);
  const int side = std::clamp(2 * image->width, 16, 2048);
  // In the light's space y is the axis of the octahedron's poles.
  glm::dmat4 exchanged(1.0);
  std::swap(exchanged[1], exchanged[2]);
  // For each face of a cube its axis, and one axis to the right and one upwards.
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      glm::dmat4 face(0.0);
      face[0][(axis + 1) % 3] = sign;
      face[1][(axis + 2) % 3] = 1.0;
      face[2][axis] = sign;
      face[3][3] = 1.0;
      const Beam beam = beam_of(side, side, 1.0, [&](int, int, const glm::dvec3& at) {
        return directions.towards(glm::dmat3(face) * at);
      });
      add_beam(context, textures, file, beam, strength, state.ctm.start * exchanged * face, location);
    }
}

}  // namespace penumbra::pbrt
