#include "scenes/pbrt/pbrt_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "scenes/pbrt/colours.h"
#include "scenes/pbrt/light_reader.h"
#include "scenes/pbrt/material_reader.h"
#include "scenes/pbrt/medium_reader.h"
#include "scenes/pbrt/shape_reader.h"
#include "scenes/pbrt/transform_reader.h"
#include "scenes/pbrt/view_reader.h"
#include "scenes/reading.h"
#include "scenes/transform.h"

namespace penumbra::pbrt {
namespace {

constexpr std::size_t kMostNesting = 1024;

class SceneParser {
 public:
  SceneParser(Context& context, TokenReader& tokens)
      : context_(context),
        report_(context.report),
        tokens_(tokens),
        textures_(context),
        materials_(context, textures_),
        media_(context),
        shapes_(context, textures_, materials_, media_) {}

  void parse() {
    defaults();
    while (!report_.full()) {
      leave_imports();
      const Token token = tokens_.next();
      if (token.kind == TokenKind::kEnd) break;
      directive(token);
    }
    finish();
  }

 private:
  struct Directive {
    const char* name;
    void (SceneParser::*read)(const Token&);
  };
  static std::span<const Directive> directives();

  void directive(const Token& token) {
    if (token.kind == TokenKind::kWord) {
      for (const Directive& each : directives())
        if (token.text == each.name) return (this->*each.read)(token);
    }
    std::vector<std::string> known;
    for (const Directive& each : directives()) known.emplace_back(each.name);
    const std::string hint = suggestion(token.text, known);
    report_.error(token.location, fmt::format("'{}' is not a directive of pbrt-v4{}", token.text,
                                              hint.empty() ? "; there are: " + list_names(known) : hint));
    // Skips to the next directive.
    for (;;) {
      const Token& next = tokens_.peek();
      if (next.kind == TokenKind::kEnd) return;
      if (next.kind == TokenKind::kWord &&
          std::ranges::any_of(directives(), [&](const Directive& d) { return next.text == d.name; }))
        return;
      tokens_.next();
    }
  }

  // --- Parts of directives

  std::string quoted(const char* what) {
    const Token token = tokens_.peek();
    if (token.kind == TokenKind::kText) return std::string(tokens_.next().text);
    report_.error(token.location, fmt::format("{} in quotes is wanted here", what));
    return "";
  }

  Parameters parameters() { return Parameters::read(tokens_, report_, state_.colour_space); }
  Parameters parameters_with(const char* target) {
    Parameters result = parameters();
    if (const auto found = state_.defaults.find(target); found != state_.defaults.end())
      result.add_defaults(found->second);
    return result;
  }

  bool in_world(const Token& token) {
    if (world_) return true;
    report_.error(token.location, fmt::format("{} belongs after WorldBegin", token.text));
    return false;
  }

  // --- Transforms

  void identity(const Token&) {
    state_.active.change(state_.ctm, [](const glm::dmat4&) { return glm::dmat4(1.0); });
  }
  void set_transform(const Token& token) {
    if (const auto m = read_transform(token, tokens_, report_))
      state_.active.change(state_.ctm, [&](const glm::dmat4&) { return *m; });
  }
  void concat_transform(const Token& token) {
    if (const auto m = read_transform(token, tokens_, report_))
      state_.active.change(state_.ctm, [&](const glm::dmat4& before) { return before * *m; });
  }
  void coordinate_system(const Token&) { systems_[quoted("a name")] = state_.ctm; }
  void coord_sys_transform(const Token& token) {
    const std::string name = quoted("a name");
    const auto found = systems_.find(name);
    if (found == systems_.end())
      return report_.error(token.location, fmt::format("there is no coordinate system '{}'", name));
    state_.ctm = found->second;
  }
  void active_transform(const Token&) {
    const Token which = tokens_.next();
    const bool all = which.text == "All";
    if (which.kind == TokenKind::kWord && (all || which.text == "StartTime" || which.text == "EndTime"))
      state_.active = {all || which.text == "StartTime", all || which.text == "EndTime"};
    else
      report_.error(which.location, "ActiveTransform is StartTime, EndTime or All");
  }
  void transform_times(const Token& token) {
    const auto times = read_numbers(2, tokens_, report_);
    if (!times) return;
    if (world_) return report_.error(token.location, "TransformTimes belongs before WorldBegin");
    if (!((*times)[1] > (*times)[0]))
      return report_.error(
          token.location,
          fmt::format("TransformTimes: the end, {}, must be after the start, {}", (*times)[1], (*times)[0]));
    context_.motion.set_times((*times)[0], (*times)[1]);
  }
  /// As in pbrt, only shapes, objects and the camera move.
  void warn_of_motion(const Token& token, const char* what) {
    if (state_.ctm.moves())
      report_.warn_counted(token.location,
                           fmt::format("{} do not move, as in pbrt: they are as at the start", what));
  }

  // --- Blocks

  void push(const Token& token, const char* end) {
    if (stack_.size() >= kMostNesting) return report_.error(token.location, "blocks are nested too deep");
    stack_.push_back({state_, end, token.location});
  }
  void pop(const Token& token, const char* begin, const char* end) {
    if (stack_.empty() || stack_.back().end != end)
      return report_.error(token.location, fmt::format("{} without {}", token.text, begin));
    state_ = std::move(stack_.back().state);
    stack_.pop_back();
  }
  void attribute_begin(const Token& token) { push(token, "AttributeEnd"); }
  void attribute_end(const Token& token) { pop(token, "AttributeBegin", "AttributeEnd"); }
  /// In pbrt-v4 TransformBegin is another word for AttributeBegin: the whole state is restored.
  void transform_begin(const Token& token) { push(token, "TransformEnd"); }
  void transform_end(const Token& token) { pop(token, "TransformBegin", "TransformEnd"); }
  void object_begin(const Token& token) {
    const std::string name = quoted("a name");
    if (shapes_.in_object()) return report_.error(token.location, "objects cannot hold others");
    if (!in_world(token)) return;
    push(token, "ObjectEnd");
    shapes_.begin_object(name, token.location);
  }
  void object_end(const Token& token) {
    pop(token, "ObjectBegin", "ObjectEnd");
    shapes_.end_object();
  }
  void object_instance(const Token& token) {
    const std::string name = quoted("a name");
    if (!in_world(token)) return;
    if (shapes_.in_object()) return report_.error(token.location, "objects cannot hold others");
    shapes_.place_object(name, state_.ctm, token.location);
  }
  void attribute(const Token&) {
    const std::string target = quoted("shape, light, material, medium or texture");
    state_.defaults[target].append(parameters());
  }
  void reverse_orientation(const Token&) { state_.reverse_orientation = !state_.reverse_orientation; }

  // --- Files

  void include(const Token& token) {
    const std::string name = quoted("the name of a file");
    if (!name.empty()) tokens_.include(name, token.location);
  }
  /// Like Include, but its graphics state ends with the file.
  void import(const Token& token) {
    const std::string name = quoted("the name of a file");
    if (name.empty()) return;
    imports_.push_back({tokens_.depth(), state_});
    tokens_.include(name, token.location);
  }
  void leave_imports() {
    if (imports_.empty()) return;
    tokens_.peek();
    while (!imports_.empty() && tokens_.depth() <= imports_.back().depth) {
      state_ = std::move(imports_.back().state);
      imports_.pop_back();
    }
  }

  // --- Contents of the scene

  void world_begin(const Token& token) {
    if (world_) return report_.error(token.location, "a second WorldBegin");
    world_ = true;
    check_exposure(context_, token.location);
    state_.ctm = {};
    state_.active = {};
    systems_["world"] = state_.ctm;
  }
  void camera(const Token& token) {
    camera_.type = quoted("a type");
    camera_.parameters = parameters();
    camera_.camera_from_world = state_.ctm;
    const auto inverse = [](const glm::dmat4& m) {
      return is_singular(m) ? glm::dmat4(1.0) : glm::inverse(m);
    };
    camera_.media = state_.media;
    camera_.location = token.location;
    read_shutter(context_, camera_);
    systems_["camera"] = {inverse(state_.ctm.start), inverse(state_.ctm.end)};
  }
  void film(const Token& token) {
    if (state_.colour_space != "srgb")
      report_.warn(token.location,
                   fmt::format("the film's colours are linear sRGB's, not {}'s", state_.colour_space));
    view(token, read_film);
  }
  void sampler(const Token& token) { view(token, read_sampler); }
  void filter(const Token& token) { view(token, read_filter); }
  void integrator(const Token& token) {
    integrator_.type = quoted("a type");
    integrator_.parameters = parameters();
    integrator_.location = token.location;
  }
  void view(const Token& token, void (*read)(Context&, const std::string&, Parameters&, SourceLocation)) {
    const std::string type = quoted("a type");
    Parameters given = parameters();
    read(context_, type, given, token.location);
  }
  void ignored(const Token&) {
    quoted("a type");
    parameters();
  }
  void option(const Token& token) {
    // A name, an optional type, and one value.
    quoted("a name");
    const bool bracketed = tokens_.peek().kind == TokenKind::kOpen;
    Token value = tokens_.next();
    while (bracketed && value.kind != TokenKind::kClose && value.kind != TokenKind::kEnd)
      value = tokens_.next();
    report_.warn_counted(token.location, "Option is ignored");
  }
  void color_space(const Token& token) {
    const std::string name = quoted("a name");
    if (is_colour_space(name))
      state_.colour_space = name;
    else
      report_.unsupported(
          token.location,
          fmt::format("the colour space '{}' is none of srgb, rec2020, dci-p3, aces2065-1", name),
          "colours are sRGB's");
  }
  void texture(const Token& token) {
    const std::string name = quoted("a name"), kind = quoted("float or spectrum"), type = quoted("a type");
    warn_of_motion(token, "textures");
    textures_.read(name, kind, type, parameters_with("texture"), state_.ctm.start, token.location);
  }
  void material(const Token& token) {
    const std::string type = quoted("a type");
    Parameters given = parameters_with("material");
    state_.material = materials_.declare(type, std::move(given), token.location);
    state_.material_name = fmt::format("material-{}", ++unnamed_materials_);
  }
  void make_named_material(const Token& token) {
    const std::string name = quoted("a name");
    Parameters given = parameters_with("material");
    const std::string type = given.text("type", "", report_);
    if (type.empty())
      return report_.error(token.location, fmt::format("the material '{}' needs a \"string type\"", name));
    materials_.declare_named(name, type, std::move(given), token.location);
  }
  void named_material(const Token& token) {
    state_.material_name = quoted("a name");
    state_.material = materials_.refer(state_.material_name, token.location);
  }
  void light_source(const Token& token) {
    const std::string type = quoted("a type");
    Parameters given = parameters_with("light");
    if (!in_world(token)) return;
    warn_of_motion(token, "lights");
    read_light(context_, textures_, type, given, state_, token.location);
  }
  void area_light_source(const Token& token) {
    const std::string type = quoted("a type");
    Parameters given = parameters_with("light");
    state_.area_light = read_area_light(context_, textures_, type, given, token.location);
  }
  void shape(const Token& token) {
    const std::string type = quoted("a type");
    Parameters given = parameters_with("shape");
    if (!in_world(token)) return;
    shapes_.read(type, given, state_, token.location);
  }
  void make_named_medium(const Token& token) {
    const std::string name = quoted("a name");
    Parameters given = parameters_with("medium");
    warn_of_motion(token, "media");
    media_.make(name, given, state_, token.location);
  }
  /// A single name stands for both sides, as in pbrt.
  void medium_interface(const Token& token) {
    state_.media.inside = state_.media.outside = quoted("a name");
    if (tokens_.peek().kind == TokenKind::kText) state_.media.outside = quoted("a name");
    state_.media.location = token.location;
  }

  // --- End of the file

  /// pbrt's defaults for directives that the file lacks.
  void defaults() {
    Parameters none;
    read_film(context_, "rgb", none, {});
    read_sampler(context_, "zsobol", none, {});
    read_filter(context_, "gaussian", none, {});
  }

  void finish() {
    const SourceLocation end = tokens_.peek().location;
    if (!report_.full()) {
      if (!stack_.empty())
        report_.error(stack_.back().begin, fmt::format("there is no {} for this", stack_.back().end));
      if (!world_) report_.error(end, "the file has no WorldBegin");
      read_camera(context_, camera_);
      read_integrator(context_, integrator_);
      materials_.finish();
      shapes_.finish();
      context_.scene.camera_medium = media_.install(camera_.media.outside, camera_.media.location);
      if (media_.any_installed()) follow_media();
      context_.motion.install(context_.scene);
    }
    textures_.install();
  }

  /// Without media, both integrators make the same image.
  void follow_media() {
    const std::string& type = integrator_.type;
    if (context_.scene.integrator.is<AmbientOcclusionIntegrator>()) return;  // which sees no media in pbrt
    if (type == "path" || type == "simplepath" || type == "randomwalk")
      return report_.warn(integrator_.location,
                          "the integrator 'path' passes through media as if they were not there, as pbrt's; "
                          "volpath follows light through them");
    if (context_.scene.integrator.is<ProgressivePhotonIntegrator>())
      return report_.warn(
          integrator_.location,
          "the integrator 'ppm' follows light through media, while pbrt's sppm passes through "
          "them as if they were not there");
    use_volumetric_integrator(context_, integrator_.location);
  }

  struct Block {
    GraphicsState state;
    std::string_view end;
    SourceLocation begin;
  };
  struct Import {
    std::size_t depth;
    GraphicsState state;
  };

  Context& context_;
  ReaderReport& report_;
  TokenReader& tokens_;
  TextureReader textures_;
  MaterialReader materials_;
  int unnamed_materials_ = 0;
  MediumReader media_;
  ShapeReader shapes_;
  GraphicsState state_;
  std::vector<Block> stack_;
  std::vector<Import> imports_;
  std::map<std::string, TransformPair> systems_;
  CameraDirective camera_;
  bool world_ = false;
  IntegratorDirective integrator_;  ///< pbrt's default is volpath
};

std::span<const SceneParser::Directive> SceneParser::directives() {
  using P = SceneParser;
  static constexpr Directive kAll[] = {{"Accelerator", &P::ignored},
                                       {"ActiveTransform", &P::active_transform},
                                       {"AreaLightSource", &P::area_light_source},
                                       {"Attribute", &P::attribute},
                                       {"AttributeBegin", &P::attribute_begin},
                                       {"AttributeEnd", &P::attribute_end},
                                       {"Camera", &P::camera},
                                       {"ColorSpace", &P::color_space},
                                       {"ConcatTransform", &P::concat_transform},
                                       {"CoordSysTransform", &P::coord_sys_transform},
                                       {"CoordinateSystem", &P::coordinate_system},
                                       {"Film", &P::film},
                                       {"Identity", &P::identity},
                                       {"Import", &P::import},
                                       {"Include", &P::include},
                                       {"Integrator", &P::integrator},
                                       {"LightSource", &P::light_source},
                                       {"LookAt", &P::concat_transform},
                                       {"MakeNamedMaterial", &P::make_named_material},
                                       {"MakeNamedMedium", &P::make_named_medium},
                                       {"Material", &P::material},
                                       {"MediumInterface", &P::medium_interface},
                                       {"NamedMaterial", &P::named_material},
                                       {"ObjectBegin", &P::object_begin},
                                       {"ObjectEnd", &P::object_end},
                                       {"ObjectInstance", &P::object_instance},
                                       {"Option", &P::option},
                                       {"PixelFilter", &P::filter},
                                       {"ReverseOrientation", &P::reverse_orientation},
                                       {"Rotate", &P::concat_transform},
                                       {"Sampler", &P::sampler},
                                       {"Scale", &P::concat_transform},
                                       {"Shape", &P::shape},
                                       {"Texture", &P::texture},
                                       {"Transform", &P::set_transform},
                                       {"TransformBegin", &P::transform_begin},
                                       {"TransformEnd", &P::transform_end},
                                       {"TransformTimes", &P::transform_times},
                                       {"Translate", &P::concat_transform},
                                       {"WorldBegin", &P::world_begin}};
  return kAll;
}

}  // namespace

Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  Reading reading(options);
  reading.refuse_variables("pbrt");
  SceneDescription scene;
  scene.source = file.string();
  Context context{reading.report, reading.files, file.parent_path(), scene};
  TokenReader tokens(reading.files, reading.report);
  tokens.enter(file, {});
  if (!reading.failed()) SceneParser(context, tokens).parse();
  return reading.finish(std::move(scene));
}

}  // namespace penumbra::pbrt
