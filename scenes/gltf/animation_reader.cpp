#include "scenes/gltf/animation_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numbers>
#include <set>
#include <string>

#include "scenes/gltf/accessor.h"

namespace penumbra::gltf {
namespace {

/// Times of keys. Errors: those of read_accessor; no keys; times before 0, or that do not ascend.
Expected<std::vector<double>> read_times(const Asset& asset, int input) {
  auto times = read_accessor(asset, input, 1, 1);
  if (!times) return std::unexpected(times.error());
  const auto wrong = [&](std::string_view message) {
    return fail(fmt::format("accessor {}: {}", input, message));
  };
  if (asset.model.accessors[std::size_t(input)].componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
    return wrong("times are floats");
  const std::vector<double>& numbers = times->numbers;
  if (numbers.empty()) return wrong("an animation needs at least one key");
  if (numbers[0] < 0.0) return wrong(fmt::format("the time of a key is at least 0 s, not {}", numbers[0]));
  for (std::size_t i = 1; i < numbers.size(); ++i)
    if (!(numbers[i] > numbers[i - 1]))
      return wrong(
          fmt::format("times must ascend: key {} at {} s comes after {} s", i, numbers[i], numbers[i - 1]));
  return std::move(times->numbers);
}

// Values from the numbers of an accessor; `count` of weights.
double value_from(const double* numbers, std::size_t /*count*/, double /*like*/) { return numbers[0]; }
glm::dvec3 value_from(const double* n, std::size_t /*count*/, glm::dvec3 /*like*/) {
  return {n[0], n[1], n[2]};
}
glm::dquat value_from(const double* n, std::size_t /*count*/, glm::dquat /*like*/) {
  return {n[3], n[0], n[1], n[2]};
}
Weights value_from(const double* numbers, std::size_t count, const Weights& /*like*/) {
  return {numbers, numbers + count};
}
template <typename Value>
constexpr std::size_t kComponents = 1;
template <>
constexpr std::size_t kComponents<glm::dvec3> = 3;
template <>
constexpr std::size_t kComponents<glm::dquat> = 4;

std::vector<std::string> split(std::string_view pointer) {
  std::vector<std::string> steps;
  while (pointer.starts_with('/')) {
    const std::size_t end = std::min(pointer.find('/', 1), pointer.size());
    steps.emplace_back(pointer.substr(1, end - 1));
    pointer.remove_prefix(end);
  }
  return steps;
}

std::optional<std::size_t> number_in(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

/// What a channel changes, as a pointer of KHR_animation_pointer.
std::string target_of(const AnimationEntry::Channel& channel) {
  return channel.path == "pointer" ? channel.pointer
                                   : fmt::format("/nodes/{}/{}", channel.node, channel.path);
}

class ClipReader {
 public:
  ClipReader(const Asset& asset, std::size_t clip, ReaderReport& report, Animation& animation)
      : asset_(asset), clip_(clip), entry_(asset.animations[clip]), report_(report), animation_(animation) {}

  void read() {
    for (channel_ = 0; channel_ < entry_.channels.size() && !report_.full(); ++channel_) {
      const AnimationEntry::Channel& channel = entry_.channels[channel_];
      if (channel.sampler < 0 || std::size_t(channel.sampler) >= entry_.samplers.size()) {
        wrong(fmt::format("'sampler' is one of the animation's {}", entry_.samplers.size()));
        continue;
      }
      is_pointer_ = channel.path == "pointer";
      if (is_pointer_ && channel.pointer.empty()) {
        wrong("a target whose path is \"pointer\" has a pointer of KHR_animation_pointer");
        continue;
      }
      // A target without a node may belong to an extension (glTF 2.0, 3.11).
      if (!is_pointer_ && channel.node < 0) continue;
      const std::string target = target_of(channel);
      if (!targets_.insert(target).second) {
        wrong(fmt::format("two channels of the animation change '{}'", target));
        continue;
      }
      read_target(target, split(target));
    }
  }

 private:
  void wrong(std::string_view message) {
    report_.error(asset_.place({"animations", clip_, "channels", channel_}), message);
  }

  void read_target(const std::string& target, const std::vector<std::string>& steps) {
    const tinygltf::Model& model = asset_.model;
    const auto is = [&](std::initializer_list<std::string_view> wanted, std::size_t number) {
      return std::ranges::equal(wanted, steps, [&](std::string_view a, const std::string& b) {
        return a == b || (a == "N" && &b == &steps[number] && number_in(b));
      });
    };
    const auto found = [&](std::size_t number, std::size_t count) -> std::optional<std::size_t> {
      const auto index = number_in(steps[number]);
      if (index && *index < count) return index;
      wrong(fmt::format("'{}' leads to nothing: there are {}", target, count));
      return std::nullopt;
    };
    for (const char* part : {"translation", "rotation", "scale", "weights"})
      if (is({"nodes", "N", part}, 1)) {
        if (const auto node = found(1, model.nodes.size())) read_node(*node, part);
        return;
      }
    if (is({"nodes", "N", "extensions", "KHR_node_visibility", "visible"}, 1)) {
      if (const auto node = found(1, model.nodes.size())) read_visibility(animation_.nodes[*node].visible);
      return;
    }
    for (const char* part : {"yfov", "xmag", "ymag"}) {
      const std::string projection = part == std::string_view("yfov") ? "perspective" : "orthographic";
      if (!is({"cameras", "N", projection, part}, 1)) continue;
      const auto camera = found(1, model.cameras.size());
      if (!camera) return;
      if (model.cameras[*camera].type != projection)
        return wrong(fmt::format("camera {} is not {}", *camera, projection));
      return read_camera(animation_.cameras[*camera], part);
    }
    for (const char* part : {"color", "intensity"})
      if (is({"extensions", "KHR_lights_punctual", "lights", "N", part}, 3)) {
        if (const auto light = found(3, model.lights.size())) read_light(animation_.lights[*light], part);
        return;
      }
    // One warning for all objects of a kind.
    std::string kind;
    for (const std::string& step : steps) kind += number_in(step) ? "/{}" : "/" + step;
    report_.warn_counted(asset_.place({"animations", clip_, "channels", channel_}),
                         fmt::format("the animation of '{}' is ignored: it does not change", kind));
  }

  void read_node(std::size_t node, std::string_view part) {
    const tinygltf::Node& target = asset_.model.nodes[node];
    NodeKeys& keys = animation_.nodes[node];
    if (part == "weights") {
      const auto& meshes = asset_.model.meshes;
      const bool has_mesh = target.mesh >= 0 && std::size_t(target.mesh) < meshes.size() &&
                            !meshes[std::size_t(target.mesh)].primitives.empty();
      const std::size_t count = has_mesh ? meshes[std::size_t(target.mesh)].primitives[0].targets.size() : 0;
      if (count == 0)
        return wrong(fmt::format("node {} has no morph targets that weights could be of", node));
      return read_keys(keys.weights, count);
    }
    if (!target.matrix.empty())
      return wrong(
          fmt::format("node {} has a 'matrix'; one that moves has translation, rotation and scale", node));
    if (part == "translation") read_keys(keys.translation, 1);
    if (part == "rotation") read_keys(keys.rotation, 1);
    if (part == "scale") read_keys(keys.scale, 1);
  }

  void read_visibility(std::optional<KeyedValue<double>>& keys) {
    read_keys(keys, 1);
    if (keys && keys->interpolation != Interpolation::kStep) wrong("visibility changes by STEP only");
  }

  void read_camera(CameraKeys& keys, std::string_view part) {
    if (part == "yfov") {
      read_keys(keys.yfov, 1);
      check(keys.yfov, "yfov must be between 0 and pi",
            [](double x) { return x > 0.0 && x < std::numbers::pi; });
    } else {
      auto& magnification = part == "xmag" ? keys.xmag : keys.ymag;
      read_keys(magnification, 1);
      check(magnification, "xmag and ymag must not be 0", [](double x) { return x != 0.0; });
    }
  }

  void read_light(LightKeys& keys, std::string_view part) {
    if (part == "color") {
      read_keys(keys.colour, 1);
      check(keys.colour, "a colour must be at least 0",
            [](const glm::dvec3& c) { return c.x >= 0.0 && c.y >= 0.0 && c.z >= 0.0; });
    } else {
      read_keys(keys.intensity, 1);
      check(keys.intensity, "an intensity must be at least 0", [](double x) { return x >= 0.0; });
    }
  }

  template <typename Value>
  void check(const std::optional<KeyedValue<Value>>& keys, std::string_view rule, const auto& holds) {
    if (keys && !std::ranges::all_of(keys->values, holds)) wrong(rule);
  }

  /// Reads the channel's keys. `count`: values of a key that are weights.
  template <typename Value>
  void read_keys(std::optional<KeyedValue<Value>>& result, std::size_t count) {
    const auto index = std::size_t(entry_.channels[channel_].sampler);
    const AnimationEntry::Sampler& sampler = entry_.samplers[index];
    const auto wrong_at = [&](const char* member, std::string_view message) {
      report_.error(asset_.place({"animations", clip_, "samplers", index, member}), message);
    };
    KeyedValue<Value> keys;
    if (sampler.interpolation == "STEP")
      keys.interpolation = Interpolation::kStep;
    else if (sampler.interpolation == "CUBICSPLINE")
      keys.interpolation = Interpolation::kCubicSpline;
    else if (sampler.interpolation != "LINEAR")
      return wrong_at("interpolation", fmt::format("'{}' is no interpolation: LINEAR, STEP, CUBICSPLINE",
                                                   sampler.interpolation));
    auto times = read_times(asset_, sampler.input);
    if (!times) return wrong_at("input", times.error().message);
    const auto values = read_accessor(asset_, sampler.output, kComponents<Value>, kComponents<Value>);
    if (!values) return wrong_at("output", values.error().message);
    const tinygltf::Accessor& output = asset_.model.accessors[std::size_t(sampler.output)];
    if (!is_pointer_ && output.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT && !output.normalized)
      return wrong_at("output", fmt::format("accessor {} has whole numbers, which must be normalised here",
                                            sampler.output));
    const bool is_cubic = keys.interpolation == Interpolation::kCubicSpline;
    const std::size_t wanted = times->size() * count * (is_cubic ? 3 : 1);
    if (values->count != wanted)
      return wrong_at("output", fmt::format("accessor {} has {} elements; {} keys{}{} need {}",
                                            sampler.output, values->count, times->size(),
                                            count > 1 ? fmt::format(" of {} weights", count) : "",
                                            is_cubic ? ", each with two tangents," : "", wanted));
    keys.times = std::move(*times);
    const std::size_t step = kComponents<Value> * count;
    const double* next = values->numbers.data();
    const auto take = [&](std::vector<Value>& to) {
      to.push_back(value_from(next, count, Value{}));
      next += step;
    };
    for (std::size_t key = 0; key < keys.times.size(); ++key) {
      if (is_cubic) take(keys.in_tangents);
      take(keys.values);
      if (is_cubic) take(keys.out_tangents);
    }
    result = std::move(keys);
  }

  const Asset& asset_;
  const std::size_t clip_;
  const AnimationEntry& entry_;
  ReaderReport& report_;
  Animation& animation_;
  std::size_t channel_ = 0;
  bool is_pointer_ = false;          ///< whether the channel is one of KHR_animation_pointer
  std::set<std::string> targets_{};  ///< of the channels so far
};

/// The time of the first and the last key. Of input that cannot be read, there are none.
Clip clip_of(const Asset& asset, std::size_t index) {
  const AnimationEntry& entry = asset.animations[index];
  Clip clip{entry.name.empty() ? fmt::to_string(index) : entry.name};
  std::set<int> inputs;
  for (const AnimationEntry::Channel& channel : entry.channels)
    if (channel.sampler >= 0 && std::size_t(channel.sampler) < entry.samplers.size())
      inputs.insert(entry.samplers[std::size_t(channel.sampler)].input);
  bool any = false;
  for (const int input : inputs) {
    const auto times = read_times(asset, input);
    if (!times) continue;
    clip.first = any ? std::min(clip.first, times->front()) : times->front();
    clip.last = any ? std::max(clip.last, times->back()) : times->back();
    any = true;
  }
  return clip;
}

/// The first clip, and each that changes nothing which one before it changes. Blender writes a clip for each
/// object that moves.
std::vector<std::size_t> compatible_clips(const Asset& asset) {
  std::vector<std::size_t> clips;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < asset.animations.size(); ++i) {
    std::set<std::string> targets;
    for (const AnimationEntry::Channel& channel : asset.animations[i].channels)
      targets.insert(target_of(channel));
    if (std::ranges::any_of(targets, [&](const std::string& target) { return taken.contains(target); }))
      continue;
    taken.merge(targets);
    clips.push_back(i);
  }
  return clips;
}

std::vector<double> numbers_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

}  // namespace

Animation read_animation(const Asset& asset, std::string_view clip, ReaderReport& report) {
  Animation result;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < asset.animations.size(); ++i) {
    result.clips.push_back(clip_of(asset, i));
    names.push_back(result.clips.back().name);
  }
  if (names.empty()) {
    if (!clip.empty())
      report.error({asset.json.get(), 0}, fmt::format("the file has no animations, so no clip '{}'", clip));
    return result;
  }
  auto chosen = std::size_t(std::ranges::find(names, clip) - names.begin());
  if (chosen == names.size()) chosen = clip.empty() ? 0 : number_in(clip).value_or(names.size());
  if (chosen >= names.size()) {
    report.error(asset.place({"animations"}),
                 fmt::format("there is no animation '{}'{}", clip, known_names(clip, names, "The file has")));
    return result;
  }
  const std::vector<std::size_t> shown =
      clip.empty() ? compatible_clips(asset) : std::vector<std::size_t>{chosen};
  if (clip.empty() && shown.size() < names.size())
    report.warn(asset.place({"animations"}),
                fmt::format("of {} animations {} shown, '{}'{}; --clip NAME shows one: {}", names.size(),
                            shown.size() == 1 ? "one is" : fmt::format("{} are", shown.size()), names[chosen],
                            shown.size() == 1 ? "" : " and those that change nothing that is changed already",
                            list_names(names)));
  result.clip = int(chosen);
  for (const std::size_t each : shown) {
    result.clips[each].is_shown = true;
    ClipReader(asset, each, report, result).read();
  }
  return result;
}

void show(const Animation& animation, double time, tinygltf::Model& model) {
  for (const auto& [index, keys] : animation.nodes) {
    tinygltf::Node& node = model.nodes[index];
    if (keys.translation) node.translation = numbers_of(value_at(*keys.translation, time));
    if (keys.scale) node.scale = numbers_of(value_at(*keys.scale, time));
    if (keys.weights) node.weights = value_at(*keys.weights, time);
    if (!keys.rotation) continue;
    const glm::dquat q = value_at(*keys.rotation, time);
    node.rotation = {q.x, q.y, q.z, q.w};
  }
  for (const auto& [index, keys] : animation.cameras) {
    tinygltf::Camera& camera = model.cameras[index];
    if (keys.yfov) camera.perspective.yfov = value_at(*keys.yfov, time);
    if (keys.xmag) camera.orthographic.xmag = value_at(*keys.xmag, time);
    if (keys.ymag) camera.orthographic.ymag = value_at(*keys.ymag, time);
  }
  for (const auto& [index, keys] : animation.lights) {
    tinygltf::Light& light = model.lights[index];
    if (keys.colour) light.color = numbers_of(value_at(*keys.colour, time));
    if (keys.intensity) light.intensity = value_at(*keys.intensity, time);
  }
}

}  // namespace penumbra::gltf
