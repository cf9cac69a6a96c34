// Animated glTF scenes written in tests.
#pragma once

#include <cmath>
#include <optional>

#include "scenes/motion/scene_motion.h"
#include "tests/scenes/gltf_text.h"

namespace penumbra {

class GltfMotion : public GltfText {
 protected:
  /// A channel and its sampler, for clip().
  struct Channel {
    std::string target, sampler;
  };
  static std::string of_node(int node, std::string_view path) {
    return fmt::format(R"({{"node": {}, "path": "{}"}})", node, path);
  }
  static std::string of_pointer(std::string_view pointer) {
    return fmt::format(
        R"({{"path": "pointer", "extensions": {{"KHR_animation_pointer": {{"pointer": "{}"}}}}}})", pointer);
  }
  static std::string sampler(int input, int output, std::string_view interpolation = "LINEAR") {
    return fmt::format(R"({{"input": {}, "output": {}, "interpolation": "{}"}})", input, output,
                       interpolation);
  }
  /// An element of "animations".
  static std::string clip(const std::vector<Channel>& channels, std::string_view name = "") {
    std::vector<std::string> samplers, targets;
    for (const Channel& channel : channels) {
      targets.push_back(fmt::format(R"({{"sampler": {}, "target": {}}})", samplers.size(), channel.target));
      samplers.push_back(channel.sampler);
    }
    return fmt::format(R"({{{}"channels": [{}], "samplers": [{}]}})",
                       name.empty() ? "" : fmt::format(R"("name": "{}", )", name), fmt::join(targets, ", "),
                       fmt::join(samplers, ", "));
  }
  /// The triangle of GltfText at node 0, and a clip with these channels.
  static std::string moving(const std::vector<Channel>& channels, std::string_view node = "",
                            std::string_view more = "") {
    return one_mesh(kTriangle, fmt::format(R"(, "animations": [{}]{})", clip(channels), more), node);
  }
  /// Keys as accessors: times, then values.
  template <typename T>
  static std::string keys(GltfFile& file, const std::vector<float>& times, const char* type,
                          std::size_t components, const std::vector<T>& values,
                          std::string_view interpolation = "LINEAR", std::string_view extra = "") {
    const int input = file.accessor<float>("SCALAR", times, times.size());
    return sampler(input, file.accessor<T>(type, values, values.size() / components, extra), interpolation);
  }
  static std::string vectors(GltfFile& file, const std::vector<float>& times,
                             const std::vector<float>& values, std::string_view interpolation = "LINEAR") {
    return keys(file, times, "VEC3", 3, values, interpolation);
  }

  static void show(SceneDescription& scene, double time) {
    const auto done = set_time(scene, time);
    EXPECT_TRUE(done) << done.error().message;
  }
  static glm::dvec3 vertex(SceneDescription& scene, double time, std::size_t index, std::size_t shape = 0) {
    show(scene, time);
    const Mesh& shown = mesh(scene, shape);
    EXPECT_LT(index, shown.positions.size());
    return index < shown.positions.size() ? shown.positions[index] : glm::dvec3(0.0);
  }
  /// Values in files are in single precision.
  static constexpr double kSingle = 1e-6;
  static void expect_near(glm::dvec3 a, glm::dvec3 b, double tolerance = kSingle) {
    EXPECT_LE(glm::distance(a, b), tolerance)
        << a.x << ' ' << a.y << ' ' << a.z << " is not " << b.x << ' ' << b.y << ' ' << b.z;
  }
};

}  // namespace penumbra
