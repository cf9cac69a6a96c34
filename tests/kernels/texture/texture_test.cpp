// Textures: decoding of texels, wrapping and filtering against a simple reference in extended precision,
// value noise, mesh colours, and nested textures; LANES at a time as well as singly.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "scenes/device/texture_tables.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra::texture_test {
namespace {

constexpr int kKinds[] = {TEXTURE_BYTE_BITMAP, TEXTURE_SHORT_BITMAP, TEXTURE_HALF_BITMAP,
                          TEXTURE_FLOAT_BITMAP};

/// By the definition of IEEE 754 binary16.
double exact_half(unsigned bits) {
  const double sign = (bits >> 15) != 0u ? -1 : 1;
  const int exponent = int(bits >> 10 & 31), digits = int(bits & 1023);
  return sign * (exponent == 0 ? std::ldexp(digits, -24) : std::ldexp(1024 + digits, exponent - 25));
}

/// A bitmap with what its values are.
struct TestBitmap {
  Bitmap bitmap;
  std::vector<double> values;

  [[nodiscard]] double at(int x, int y, int channel) const {
    const int c = bitmap.channels == 1 ? 0 : channel;
    return values[std::size_t((y * bitmap.width + x) * bitmap.channels + c)];
  }
};

TestBitmap random_bitmap(RandomNumbers& random, TexelType type, float gamma, int width, int height,
                         int channels) {
  TestBitmap test;
  test.bitmap.width = width;
  test.bitmap.height = height;
  test.bitmap.channels = channels;
  test.bitmap.type = type;
  std::vector<std::uint8_t> bytes;
  const auto put = [&](const auto& value) {
    const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
  };
  for (int i = 0; i < width * height * channels; ++i) {
    if (type == TexelType::kByte) {
      const auto n = std::uint8_t(random.below(256));
      put(n);
      test.values.push_back(decoded_value(n, 255, gamma));
    } else if (type == TexelType::kShort) {
      const auto n = std::uint16_t(random.below(65536));
      put(n);
      test.values.push_back(decoded_value(n, 65535, gamma));
    } else if (type == TexelType::kHalf) {
      const auto bits = std::uint16_t(random.below(2) << 15 | random.below(0x4000));  // below 2
      put(bits);
      test.values.push_back(exact_half(bits));
    } else {
      const auto value = float(random.between(-1, 2));
      put(value);
      test.values.push_back(value);
    }
  }
  bytes.resize((bytes.size() + 3) / 4 * 4);
  test.bitmap.words.resize(bytes.size() / 4);
  std::memcpy(test.bitmap.words.data(), bytes.data(), bytes.size());
  return test;
}

/// A scene of these textures, none of them with a transform.
class TextureScene {
 public:
  int add(const TextureNode& node) {
    tables_.textures.push_back(node);
    TextureNode& added = tables_.textures.back();
    added.u_by_u = added.v_by_v = 1;
    return int(tables_.textures.size()) - 1;
  }
  int add(const BitmapTexture& texture, const Bitmap& bitmap) {
    bitmaps_.assign(1, std::make_shared<const Bitmap>(bitmap));
    TexelTable texels(bitmaps_);
    BitmapTexture first = texture;
    first.bitmap = 0;
    TextureNode node = texture_of(first);
    texels.place(first, node);
    const int moved = int(tables_.texels.size());
    node.texels += moved;
    if (node.decoding >= 0) node.decoding += moved;
    const std::vector<std::uint32_t> words = texels.take();
    tables_.texels.insert(tables_.texels.end(), words.begin(), words.end());
    return add(node);
  }

  SceneTables& tables() { return tables_; }

  /// Of LANES surfaces, the same texture or none in each.
  std::vector<vec3> eval(const std::vector<int>& textures, const std::vector<Surface>& surfaces) {
    tables_.texels.resize(std::max<std::size_t>(tables_.texels.size(), LEAST_TEXELS));
    const Scene scene = tables_.scene();
    Surfaces lanes;
    int of_lane[LANES];
    for (int j = 0; j < LANES; ++j) {
      store_surface(&lanes, j, surfaces[std::size_t(j)]);
      of_lane[j] = textures[std::size_t(j)];
    }
    TextureLanes found;
    eval_textures(&scene, &lanes, of_lane, &found);
    std::vector<vec3> values;
    for (int j = 0; j < LANES; ++j) values.push_back(load_texture_lane(&found, j).value);
    return values;
  }
  vec3 eval(int texture, float u, float v) {
    return eval(std::vector<int>(LANES, texture), std::vector<Surface>(LANES, at(u, v)))[0];
  }

  static Surface at(float u, float v) {
    Surface s = surface_in_medium(make_vec3(0, 0, 0));
    s.u = u;
    s.v = v;
    return s;
  }

 private:
  SceneTables tables_;
  std::vector<std::shared_ptr<const Bitmap>> bitmaps_;
};

TEST(Texels, OfHalfPrecisionAreExact) {
  for (unsigned bits = 0; bits < 0x10000; ++bits) {
    if ((bits >> 10 & 31) == 31) continue;  // not finite
    ASSERT_EQ(half_value(bits), float(exact_half(bits))) << bits;
  }
}

TEST(Texels, OfWholeNumbersAreDecodedOnce) {
  // IEC 61966-2-1 at its knee and ends.
  EXPECT_EQ(decoded_value(0, 255, kSrgb), 0.0f);
  EXPECT_EQ(decoded_value(255, 255, kSrgb), 1.0f);
  EXPECT_EQ(decoded_value(10, 255, kSrgb), float(10.0 / 255 / 12.92));
  EXPECT_NEAR(decoded_value(128, 255, kSrgb), 0.2158605, 1e-7);
  EXPECT_EQ(decoded_value(51, 255, 1.0f), 0.2f);
  EXPECT_EQ(decoded_value(51, 255, 2.0f), float(0.04));
  for (const int most : {255, 65535})
    for (int n = 1; n <= most; ++n)
      ASSERT_GT(decoded_value(n, most, kSrgb), decoded_value(n - 1, most, kSrgb));
}

TEST(Texels, OfAllFormatsAreFoundWhereTheyAre) {
  RandomNumbers random(1);
  for (const TexelType type : {TexelType::kByte, TexelType::kShort, TexelType::kHalf, TexelType::kFloat})
    for (const float gamma : {kSrgb, 1.0f, 2.2f})
      for (const int channels : {1, 3}) {
        TextureScene scene;
        // Others before it, so that it does not begin where the table does.
        BitmapTexture texture;
        texture.gamma = gamma;
        texture.filter = BitmapFilter::kNearest;
        scene.add(texture, random_bitmap(random, TexelType::kByte, gamma, 3, 1, 3).bitmap);
        const TestBitmap test = random_bitmap(random, type, gamma, 7, 5, channels);
        const int index = scene.add(texture, test.bitmap);
        EXPECT_EQ(scene.tables().textures[std::size_t(index)].kind, kKinds[int(type)]);
        for (int y = 0; y < 5; ++y)
          for (int x = 0; x < 7; ++x) {
            const vec3 value = scene.eval(index, (float(x) + 0.5f) / 7, (float(y) + 0.5f) / 5);
            ASSERT_EQ(value.x, float(test.at(x, y, 0))) << x << ' ' << y;
            ASSERT_EQ(value.y, float(test.at(x, y, 1)));
            ASSERT_EQ(value.z, float(test.at(x, y, 2)));
          }
      }
}

/// What texel i of an axis is: a whole number of steps away is another copy, or the border.
struct ReferenceTexel {
  int index;
  double border;  ///< negative: none
};
ReferenceTexel reference_texel(int wrap, int size, long i) {
  const bool inside = i >= 0 && i < size;
  if (wrap == WRAP_ZERO || wrap == WRAP_ONE)
    return {inside ? int(i) : 0, inside ? -1.0 : wrap == WRAP_ONE ? 1.0 : 0.0};
  if (wrap == WRAP_CLAMP) return {int(std::clamp<long>(i, 0, size - 1)), -1};
  const long period = wrap == WRAP_MIRROR ? 2 * size : size;
  long at = i % period;
  if (at < 0) at += period;
  return {int(at < size ? at : 2 * size - 1 - at), -1};
}

double reference(const TestBitmap& test, const BitmapTexture& texture, float u, float v, int channel) {
  const double half = texture.filter == BitmapFilter::kNearest ? 0.0 : 0.5;
  const double x = double(u) * test.bitmap.width - half, y = double(v) * test.bitmap.height - half;
  const long i = long(std::floor(x)), j = long(std::floor(y));
  const auto texel = [&](long a, long b) {
    const ReferenceTexel at_u = reference_texel(texture.wrap_u, test.bitmap.width, a),
                         at_v = reference_texel(texture.wrap_v, test.bitmap.height, b);
    if (at_u.border >= 0) return at_u.border;
    if (at_v.border >= 0) return at_v.border;
    return test.at(at_u.index, at_v.index, channel);
  };
  if (half == 0.0) return texel(i, j);
  const double s = x - double(i), t = y - double(j);
  return (1 - t) * ((1 - s) * texel(i, j) + s * texel(i + 1, j)) +
         t * ((1 - s) * texel(i, j + 1) + s * texel(i + 1, j + 1));
}

TEST(Bitmaps, WrapAndFilterAsAPlainReference) {
  RandomNumbers random(2);
  for (const int wrap_u : {WRAP_REPEAT, WRAP_MIRROR, WRAP_CLAMP, WRAP_ZERO, WRAP_ONE})
    for (const int wrap_v : {WRAP_REPEAT, WRAP_MIRROR, WRAP_CLAMP, WRAP_ZERO, WRAP_ONE})
      for (const BitmapFilter filter : {BitmapFilter::kNearest, BitmapFilter::kBilinear})
        for (const int width : {1, 2, 5}) {
          BitmapTexture texture;
          texture.wrap_u = wrap_u;
          texture.wrap_v = wrap_v;
          texture.filter = filter;
          texture.gamma = 1.0f;
          const int height = width == 5 ? 3 : width;
          const TestBitmap test = random_bitmap(random, TexelType::kByte, 1.0f, width, height, 3);
          TextureScene scene;
          const int index = scene.add(texture, test.bitmap);
          for (int k = 0; k < 400; ++k) {
            const auto u = float(random.between(-3, 4)), v = float(random.between(-3, 4));
            // Rounding may put a place on a texel's edge to its other side.
            const double x = double(u) * width, y = double(v) * height;
            const bool at_edge = std::abs(x - std::round(x)) < 1e-5 || std::abs(y - std::round(y)) < 1e-5;
            if (filter == BitmapFilter::kNearest && at_edge) continue;
            const vec3 value = scene.eval(index, u, v);
            const float channels[3] = {value.x, value.y, value.z};
            // The place is rounded to 4 2^-24, 20 times as much in texels; a value changes by 1 at most per
            // texel, twice as much along both axes.
            for (int c = 0; c < 3; ++c)
              ASSERT_NEAR(channels[c], reference(test, texture, u, v, c), 2e-5)
                  << "wrap " << wrap_u << ' ' << wrap_v << ", width " << width << ", at " << u << ' ' << v;
          }
        }
}

TEST(Bitmaps, OfOneColourHaveItEverywhere) {
  RandomNumbers random(3);
  TestBitmap test = random_bitmap(random, TexelType::kByte, kSrgb, 4, 4, 1);
  for (std::uint32_t& word : test.bitmap.words) word = 0x37373737u;
  TextureScene scene;
  const int index = scene.add(BitmapTexture{}, test.bitmap);
  for (int k = 0; k < 1000; ++k) {
    const vec3 value = scene.eval(index, float(random.between(-9, 9)), float(random.between(-9, 9)));
    ASSERT_EQ(value.x, decoded_value(0x37, 255, kSrgb));
    ASSERT_EQ(luminance(value), value.x);
  }
}

TEST(Bitmaps, AnswerWhateverTheyAreAsked) {
  RandomNumbers random(4);
  const float odd[] = {0.0f,
                       -0.0f,
                       1.0f,
                       -1.0f,
                       ONE_MINUS_EPSILON,
                       -1e-30f,
                       1e30f,
                       -1e30f,
                       std::numeric_limits<float>::max(),
                       std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity(),
                       std::numeric_limits<float>::quiet_NaN()};
  for (const int wrap : {WRAP_REPEAT, WRAP_MIRROR, WRAP_CLAMP, WRAP_ZERO, WRAP_ONE})
    for (const BitmapFilter filter : {BitmapFilter::kNearest, BitmapFilter::kBilinear}) {
      BitmapTexture texture;
      texture.wrap_u = texture.wrap_v = wrap;
      texture.filter = filter;
      TextureScene scene;
      const int index = scene.add(texture, random_bitmap(random, TexelType::kShort, kSrgb, 3, 2, 3).bitmap);
      for (const float u : odd)
        for (const float v : odd) {
          const vec3 value = scene.eval(index, u, v);
          for (const float channel : {value.x, value.y, value.z}) {
            ASSERT_GE(channel, 0.0f) << u << ' ' << v;
            ASSERT_LE(channel, 1.0f) << u << ' ' << v;
          }
        }
    }
}

TEST(Textures, InLanesAreThoseOfEachByItself) {
  RandomNumbers random(5);
  TextureScene scene;
  for (const TexelType type : {TexelType::kByte, TexelType::kShort, TexelType::kHalf, TexelType::kFloat})
    for (const float gamma : {kSrgb, 1.0f}) {
      BitmapTexture texture;
      texture.gamma = gamma;
      texture.wrap_u = int(random.below(5));
      scene.add(texture, random_bitmap(random, type, gamma, 5, 4, gamma == 1.0f ? 1 : 3).bitmap);
    }
  NoiseTexture noise;
  noise.octaves = 3;
  scene.add(texture_of(noise));
  const int plain = int(scene.tables().textures.size());
  ScaleTexture half{glm::vec3(0.5f, 0.25f, 2.0f), 1};
  scene.add(texture_of(half));
  CheckerboardTexture board;
  board.color0.texture = plain;
  board.color1.texture = 3;
  scene.add(texture_of(board));
  half.texture = plain + 1;
  scene.add(texture_of(half));
  for (int k = 0; k < 3000; ++k) {
    std::vector<int> textures;
    std::vector<Surface> surfaces;
    for (int j = 0; j < LANES; ++j) {
      textures.push_back(int(random.below(scene.tables().textures.size() + 1)) - 1);
      surfaces.push_back(TextureScene::at(float(random.between(-2, 3)), float(random.between(-2, 3))));
    }
    const std::vector<vec3> together = scene.eval(textures, surfaces);
    const std::size_t j = random.below(LANES);
    const vec3 alone = scene.eval(textures[j], surfaces[j].u, surfaces[j].v);
    ASSERT_TRUE(alone.x == together[j].x && alone.y == together[j].y && alone.z == together[j].z)
        << "texture " << textures[j];
    if (textures[j] < 0) {
      ASSERT_TRUE(alone.x == 1.0f && alone.y == 1.0f && alone.z == 1.0f);
    }
  }
  // A walk through three: scale, checkerboard, scale, bitmap.
  const vec3 inner = scene.eval(1, 0.25f, 0.25f), outer = scene.eval(plain + 2, 0.25f, 0.25f);
  // Times 0.5 0.25 2 twice, and the colour of the checkerboard, which a texture stands for.
  EXPECT_NEAR(outer.x, 0.4f * 0.25f * inner.x, 1e-6);
  EXPECT_NEAR(outer.z, 0.4f * 4.0f * inner.z, 1e-6);
}

TEST(Noise, IsItsLatticesNumbersAndContinuous) {
  NoiseTexture noise;
  noise.octaves = 1;
  noise.seed = 7;
  TextureScene scene;
  const int index = scene.add(texture_of(noise));
  double sum = 0, squares = 0;
  constexpr int kSide = 60;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const auto u = float(i - kSide / 2), v = float(j - kSide / 2);
      const float here = scene.eval(index, u, v).x;
      ASSERT_EQ(here, lattice_value(hash_uint(7), i - kSide / 2, j - kSide / 2));
      ASSERT_NEAR(scene.eval(index, u - 1e-4f, v - 1e-4f).x, here, 1e-5) << "level at lattice points";
      const float right = scene.eval(index, u + 1, v).x, middle = scene.eval(index, u + 0.5f, v).x;
      ASSERT_NEAR(middle, 0.5f * (here + right), 1e-6);
      const float third = scene.eval(index, u + 1.0f / 3, v).x;
      ASSERT_NEAR(third, here + 0.25 * (right - here), 1e-6) << "(1 - cos 60 degrees) / 2";
      sum += here;
      squares += here * here;
    }
  // Uniform: mean 1/2, variance 1/12; five standard errors of 3600 numbers.
  const double n = kSide * kSide, mean = sum / n;
  EXPECT_NEAR(mean, 0.5, 5 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(squares / n - mean * mean, 1.0 / 12, 5 * std::sqrt(1.0 / 180 / n));
}

TEST(Noise, OfOctavesIsTheirWeightedMean) {
  NoiseTexture noise;
  noise.persistence = 0.7f;
  noise.lacunarity = 3.0f;
  noise.seed = 1;
  noise.color0 = glm::vec3(1, 2, 3);
  noise.color1 = glm::vec3(2, 2, 1);
  RandomNumbers random(6);
  for (int octaves = 1; octaves <= MAX_NOISE_OCTAVES; ++octaves) {
    noise.octaves = octaves;
    TextureScene scene;
    const int index = scene.add(texture_of(noise));
    for (int k = 0; k < 50; ++k) {
      const auto u = float(random.between(-2, 2)), v = float(random.between(-2, 2));
      double sum = 0, weights = 0;
      uint seed = 1;
      for (int o = 0; o < octaves; ++o) {
        seed = hash_uint(seed + uint(o));
        const double weight = std::pow(0.7, o), frequency = std::pow(3.0, o);
        const auto smooth = [](double t) { return 0.5 * (1 - std::cos(M_PI * t)); };
        const double x = frequency * u, y = frequency * v, i = std::floor(x), j = std::floor(y);
        const auto at = [&](int a, int b) { return double(lattice_value(seed, int(i) + a, int(j) + b)); };
        const double s = smooth(x - i), t = smooth(y - j);
        sum += weight *
               ((1 - t) * ((1 - s) * at(0, 0) + s * at(1, 0)) + t * ((1 - s) * at(0, 1) + s * at(1, 1)));
        weights += weight;
      }
      const vec3 value = scene.eval(index, u, v);
      // At frequency 3^9 a coordinate's rounding is 2e-3, at a weight of 0.04 / 3.
      ASSERT_NEAR(value.x, 1 + sum / weights, octaves < 5 ? 1e-4 : 2e-3);
      ASSERT_EQ(value.y, 2.0f);
      ASSERT_NEAR(value.z, 3 - 2 * sum / weights, octaves < 5 ? 2e-4 : 4e-3);
    }
  }
}

TEST(MeshColours, AreInterpolatedBetweenVertices) {
  RandomNumbers random(7);
  TextureScene scene;
  SceneTables& tables = scene.tables();
  for (int k = 0; k < 8; ++k) {
    vec3 p[3];
    do {
      for (vec3& each : p) each = rounded(random.point(2));
    } while (length3(cross3(sub(p[1], p[0]), sub(p[2], p[0]))) < 0.5f);
    tables.add_triangle(p[0], p[1], p[2]);
    // Two attributes each; the last triangles have none.
    tables.triangle_colours.push_back(k < 6 ? int(tables.vertex_colours.size()) : -1);
    const auto colour = [&] { return rounded(random.point(1)); };
    for (int a = 0; k < 6 && a < 2; ++a) tables.vertex_colours.push_back({colour(), colour(), colour()});
  }
  TextureNode node = texture_of(MeshAttributeTexture{});
  scene.add(node);
  node.attribute = 1;
  node.colour0 = make_vec3(2, 2, 2);
  scene.add(node);
  for (int k = 0; k < 4000; ++k) {
    std::vector<Surface> surfaces;
    std::vector<vec3> expected;
    std::vector<int> textures;
    for (int j = 0; j < LANES; ++j) {
      Surface s = surface_in_medium(make_vec3(0, 0, 0));
      const int triangle = int(random.below(8)), attribute = int(random.below(2));
      const long double root = std::sqrt((long double)random.uniform());
      const long double b1 = root * random.uniform(), b2 = root - b1, b0 = 1 - root;
      const Triangle& t = tables.triangles[std::size_t(triangle)];
      s.primitive = triangle;
      s.p = rounded(b0 * exact(t.p0) + b1 * exact(t.p1) + b2 * exact(t.p2));
      surfaces.push_back(s);
      textures.push_back(attribute);
      const int first = tables.triangle_colours[std::size_t(triangle)];
      if (first < 0) {
        expected.push_back(make_vec3(0, 0, 0));
        continue;
      }
      const VertexColours& c = tables.vertex_colours[std::size_t(first + attribute)];
      expected.push_back(
          rounded((attribute + 1.0L) * (b0 * exact(c.c0) + b1 * exact(c.c1) + b2 * exact(c.c2))));
    }
    const std::vector<vec3> values = scene.eval(textures, surfaces);
    for (std::size_t j = 0; j < values.size(); ++j) {
      ASSERT_NEAR(values[j].x, expected[j].x, 1e-4);
      ASSERT_NEAR(values[j].y, expected[j].y, 1e-4);
      ASSERT_NEAR(values[j].z, expected[j].z, 1e-4);
    }
  }
  // A sphere has none.
  Surface s = surface_in_medium(make_vec3(0, 0, 0));
  s.primitive = 8;
  EXPECT_EQ(scene.eval(std::vector<int>(LANES, 0), std::vector<Surface>(LANES, s))[0].x, 0.0f);
}

}  // namespace
}  // namespace penumbra::texture_test
