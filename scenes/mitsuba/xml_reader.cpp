#include "scenes/mitsuba/xml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <pugixml.hpp>
#include <set>

#include "scenes/mitsuba/value_reader.h"
#include "scenes/mitsuba/xml_source.h"
#include "scenes/names.h"
#include "scenes/number.h"

namespace penumbra::mitsuba {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxIncludeDepth = 16;
constexpr std::size_t kMaxFiles =
    256;  ///< limit on includes; a chain of files that each include the next one twice doubles every time
constexpr std::uint64_t kMaxTotalBytes = std::uint64_t{256} << 20;
constexpr std::size_t kMaxParameters = 256;  ///< per object; no plugin has nearly as many
constexpr std::size_t kMaxSubstitutedBytes = std::size_t{1} << 20;        ///< per text
constexpr std::size_t kMaxTotalSubstitutedBytes = std::size_t{16} << 20;  ///< over all texts

const std::vector<std::string> kObjectTags = {"bsdf",  "shape",   "emitter",    "texture",    "sensor",
                                              "film",  "sampler", "rfilter",    "integrator", "medium",
                                              "phase", "volume",  "subsurface", "blackbody",  "spectrum"};
const std::vector<std::string> kTopLevelTags = {"default", "include", "path", "alias"};

bool is_object(const pugi::xml_node& element) {
  return std::find(kObjectTags.begin(), kObjectTags.end(), element.name()) != kObjectTags.end();
}

bool is_name_char(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

class XmlReader {
 public:
  XmlReader(const ReadOptions& options, const FileAccess& files, Diagnostics& diagnostics,
            const XmlDialect* dialect)
      : options_(options), access_(files), diagnostics_(diagnostics), dialect_(dialect) {
    for (const auto* given : {&options.variables, &options.defines})
      for (const auto& [name, value] : *given) variables_[name] = value;
  }

  ObjectTree read(const fs::path& file) {
    tree_.folders.push_back(file.parent_path());
    tree_.scene.tag = "scene";
    read_file(file, {});
    for (const Alias& alias : aliases_) resolve(alias);
    if (!diagnostics_.failed()) check_defines();
    tree_.uses_variables = std::ranges::any_of(
        options_.variables, [&](const auto& variable) { return used_.contains(variable.first); });
    return std::move(tree_);
  }

 private:
  struct Alias {
    std::string id, as;
    SourceLocation location;
  };

  // --- Files

  void read_file(const fs::path& file, SourceLocation named_at) {
    if (including_.size() >= kMaxIncludeDepth || tree_.files.size() >= kMaxFiles) {
      diagnostics_.error(named_at, fmt::format("too many includes: at most {} deep, {} files in all",
                                               kMaxIncludeDepth, kMaxFiles));
      return;
    }
    auto source = access_.read(file, kMaxSceneFileBytes);
    if (!source) {
      diagnostics_.error(named_at, source.error().message);
      return;
    }
    total_bytes_ += (*source)->text.size();
    if (total_bytes_ > kMaxTotalBytes) {
      diagnostics_.error(named_at, fmt::format("the scene's files have more than {} bytes", kMaxTotalBytes));
      return;
    }
    tree_.files.push_back(std::move(*source));
    const SourceFile& text = *tree_.files.back();
    if (tree_.files.size() == 1) tree_.scene.location = {&text, 0};
    std::error_code ignored;
    including_.push_back(fs::weakly_canonical(file, ignored));
    pugi::xml_document document;
    if (const auto parsed = parse_xml(text, document); !parsed) {
      diagnostics_.error_text(parsed.error().message);
    } else {
      if (dialect_ != nullptr) dialect_->adapt(document);
      read_root(text, document);
    }
    including_.pop_back();
  }

  void read_root(const SourceFile& file, const pugi::xml_document& document) {
    const ElementReader root(file, document.document_element(), substitute_, diagnostics_);
    if (std::string_view(root.element().name()) != "scene") {
      root.wrong(
          fmt::format("a Mitsuba scene file has the root element <scene>, not <{}>", root.element().name()));
      return;
    }
    root.check_attributes({"version", "id"});
    check_version(root);
    for (const pugi::xml_node& element : root.element().children()) {
      if (element.type() != pugi::node_element) continue;
      if (diagnostics_.full()) break;
      read_top_level(file, root.child(element));
    }
  }

  void check_version(const ElementReader& root) {
    if (dialect_ != nullptr) {
      tree_.major_version = 0;
      tree_.is_tolerant = true;
      return;
    }
    const auto version = root.required("version");
    if (!version) return;
    std::vector<std::int64_t> parts;
    std::string_view rest = *version;
    for (;;) {
      const std::size_t dot = rest.find('.');
      const auto part = parse_integer(rest.substr(0, dot), 0, 1000000);
      if (!part || parts.size() == 3) {
        root.wrong_value("version", fmt::format("'{}' is not a version such as 3.0.0", *version));
        return;
      }
      parts.push_back(*part);
      if (dot == rest.npos) break;
      rest.remove_prefix(dot + 1);
    }
    if (tree_.files.size() == 1) {
      tree_.major_version = parts[0];
      tree_.is_tolerant = parts[0] == 0;  // version 2 and later reject unknown parameters
    }
    const std::int64_t major = parts[0], minor = parts.size() > 1 ? parts[1] : 0;
    if (major > 3 || (major == 0 && minor < 4)) {
      root.wrong_value("version", fmt::format("version {} is not read; 0.4 to 3.x are", *version));
    }
  }

  void read_top_level(const SourceFile& file, const ElementReader& element) {
    const std::string_view tag = element.element().name();
    if (tag == "default") {
      read_default(element);
    } else if (tag == "include") {
      read_include(file, element);
    } else if (tag == "path") {
      read_path(file, element);
    } else if (tag == "alias") {
      read_alias(element);
    } else {
      read_into(tree_.scene, element);
    }
  }

  void read_default(const ElementReader& element) {
    if (!element.check_attributes({"name", "value"})) return;
    const auto name = element.required("name");
    const auto value = element.required("value");
    if (!name || !value) return;
    if (name->empty() || !std::all_of(name->begin(), name->end(), is_name_char)) {
      element.wrong_value("name", "a variable's name has letters, digits and underscores");
      return;
    }
    used_.insert(*name);
    variables_.try_emplace(*name, *value);
  }

  /// The folders for names in `file`: its own, the scene's, and each <path>.
  std::vector<fs::path> folders_of(const SourceFile& file) const {
    std::vector<fs::path> folders = {file.path.parent_path()};
    folders.insert(folders.end(), tree_.folders.begin(), tree_.folders.end());
    return folders;
  }

  void read_include(const SourceFile& file, const ElementReader& element) {
    if (!element.check_attributes({"filename"})) return;
    const auto name = element.required("filename");
    if (!name) return;
    const auto found = access_.find(*name, folders_of(file));
    if (!found) {
      element.wrong_value("filename", found.error().message);
      return;
    }
    std::error_code ignored;
    const fs::path canonical = fs::weakly_canonical(*found, ignored);
    const auto open = std::find(including_.begin(), including_.end(), canonical);
    if (open != including_.end()) {
      std::string chain;
      for (auto each = open; each != including_.end(); ++each) chain += each->filename().string() + " → ";
      element.wrong_value(
          "filename", fmt::format("the file includes itself: {}{}", chain, canonical.filename().string()));
      return;
    }
    read_file(*found, element.value_location("filename"));
  }

  void read_path(const SourceFile& file, const ElementReader& element) {
    if (!element.check_attributes({"value"})) return;
    const auto name = element.required("value");
    if (!name) return;
    const std::vector<fs::path> beside = {file.path.parent_path(), tree_.folders.front()};
    const auto found = access_.find(*name, beside);
    std::error_code ignored;
    const auto is_allowed = [&](const fs::path& folder) { return access_.allows(folder / *name); };
    if (!found && std::ranges::all_of(beside, is_allowed)) {
      // Files often keep a path of the machine that they were made on.
      diagnostics_.warn(element.value_location("value"),
                        fmt::format("there is no folder '{}'; nothing is looked for there", *name));
    } else if (!found) {
      element.wrong_value("value", found.error().message);
    } else if (!fs::is_directory(*found, ignored)) {
      element.wrong_value("value", fmt::format("'{}' is not a folder", found->string()));
    } else {
      tree_.folders.push_back(*found);
    }
  }

  void read_alias(const ElementReader& element) {
    if (!element.check_attributes({"id", "as"})) return;
    const auto id = element.required("id");
    const auto as = element.required("as");
    if (id && as) aliases_.push_back({*id, *as, element.location()});
  }

  void resolve(const Alias& alias) {
    const auto found = tree_.by_id.find(alias.id);
    if (found == tree_.by_id.end()) {
      diagnostics_.error(alias.location, fmt::format("there is no object with the id '{}'", alias.id));
    } else {
      name_object(alias.as, *found->second, alias.location);
    }
  }

  // --- Objects

  void read_into(Object& parent, const ElementReader& element) {
    const std::string_view tag = element.element().name();
    if (is_value(element.element())) {
      add_parameter(parent, element);
    } else if (tag == "ref") {
      add_reference(parent, element);
    } else if (is_object(element.element())) {
      add_object(parent, element);
    } else {
      std::vector<std::string> known = kObjectTags;
      known.insert(known.end(), value_tags().begin(), value_tags().end());
      known.emplace_back("ref");
      if (parent.tag == "scene") known.insert(known.end(), kTopLevelTags.begin(), kTopLevelTags.end());
      const bool misplaced =
          std::find(kTopLevelTags.begin(), kTopLevelTags.end(), tag) != kTopLevelTags.end();
      const std::string hint = suggestion(tag, known);
      element.wrong(misplaced
                        ? fmt::format("<{}> belongs directly into <scene>, not into <{}>", tag, parent.tag)
                        : fmt::format("<{}> is not an element of a scene file{}", tag,
                                      hint.empty() ? "; there are: " + list_names(known) : hint));
    }
  }

  void add_parameter(Object& parent, const ElementReader& element) {
    auto parameter = read_value(element);
    if (!parameter) return;
    if (parent.parameters.size() >= kMaxParameters) {
      element.wrong(fmt::format("<{}> has more than {} parameters", parent.tag, kMaxParameters));
      return;
    }
    const auto same = std::find_if(parent.parameters.begin(), parent.parameters.end(),
                                   [&](const Parameter& p) { return p.name == parameter->name; });
    if (same != parent.parameters.end()) {
      if (tree_.is_tolerant || options_.lenient) {
        diagnostics_.warn_counted(
            element.location(),
            fmt::format("the parameter '{}' is there twice; the last counts", parameter->name));
        *same = std::move(*parameter);
        return;
      }
      element.wrong(fmt::format("the parameter '{}' is there twice; first at {}", parameter->name,
                                describe(same->location)));
      return;
    }
    parent.parameters.push_back(std::move(*parameter));
  }

  void add_reference(Object& parent, const ElementReader& element) {
    if (!element.check_attributes({"id", "name"})) return;
    const auto id = element.required("id");
    const auto name = element.attribute("name");
    if (id)
      parent.children.push_back(
          {to_snake_case(name.value_or("")), nullptr, *id, element.value_location("id")});
  }

  void add_object(Object& parent, const ElementReader& element) {
    Object& object = tree_.objects.emplace_back();
    object.tag = element.element().name();
    object.location = element.location();
    object.type_location = element.value_location("type");
    if (object.tag == "blackbody") {  // a value with two attributes, which looks unlike a plugin
      object.type = "blackbody";
      if (element.check_attributes({"name", "temperature", "scale"})) {
        add_attribute(object, element, "temperature");
        add_attribute(object, element, "scale");
      }
    } else {
      element.check_attributes({"type", "id", "name"});
      const auto type = element.required("type");
      object.type = to_snake_case(type.value_or(""));
    }
    const auto id = element.attribute("id");
    const auto name = element.attribute("name");
    if (id && !id->empty()) {
      name_object(*id, object, element.value_location("id"));
      object.id = std::move(*id);
    }
    for (const pugi::xml_node& child : element.element().children()) {
      if (child.type() == pugi::node_element) read_into(object, element.child(child));
    }
    parent.children.push_back({to_snake_case(name.value_or("")), &object, "", object.location});
  }

  /// Adds an attribute as if it were a parameter of that name; as a number, if it is one.
  static void add_attribute(Object& object, const ElementReader& element, const char* name) {
    const auto text = element.attribute(name);
    if (!text) return;
    const SourceLocation place = element.value_location(name);
    const auto number = parse_number(*text);
    object.parameters.push_back({name, "float", number ? Value(*number) : Value(*text), *text, place, place});
  }

  void name_object(const std::string& id, Object& object, SourceLocation location) {
    if (const auto checked = check_name_length("id", id); !checked)
      return diagnostics_.error(location, checked.error().message);
    const auto [entry, is_new] = tree_.by_id.try_emplace(id, &object);
    if (!is_new) {
      diagnostics_.error(
          location, fmt::format("the id '{}' is taken: first at {}", id, describe(entry->second->location)));
    }
  }

  // --- $variables

  std::optional<std::string> substitute(std::string_view text, SourceLocation location) {
    if (diagnostics_.full()) return std::nullopt;
    std::string result;
    std::size_t at = 0;
    for (std::size_t dollar = text.find('$'); dollar != text.npos; dollar = text.find('$', at)) {
      result += text.substr(at, dollar - at);
      std::size_t end = dollar + 1;
      while (end < text.size() && is_name_char(text[end])) ++end;
      // "$resx" is the variable "resx", or if there is none, "res" followed by an x.
      auto found = variables_.end();
      std::size_t length = end - dollar - 1;
      for (; length > 0 && found == variables_.end(); --length) {
        found = variables_.find(std::string(text.substr(dollar + 1, length)));
        if (found != variables_.end()) break;
      }
      if (found == variables_.end()) {
        const std::string name(text.substr(dollar + 1, end - dollar - 1));
        std::vector<std::string> known;
        for (const auto& [key, value] : variables_) known.push_back(key);
        diagnostics_.error(
            location, fmt::format("${} is not defined{} Give it a <default> before its use, or -D {}=…", name,
                                  suggestion(name, known).empty() ? "." : suggestion(name, known), name));
        return std::nullopt;
      }
      used_.insert(found->first);
      result += found->second;
      at = dollar + 1 + length;
      substituted_bytes_ += found->second.size();
      if (result.size() > kMaxSubstitutedBytes || substituted_bytes_ > kMaxTotalSubstitutedBytes) {
        const bool one = result.size() > kMaxSubstitutedBytes;
        diagnostics_.error(
            location, fmt::format("{} too long once {} variables are filled in: with ${}, of {} bytes, more "
                                  "than {}",
                                  one ? "the text is" : "the scene's texts are together",
                                  one ? "its" : "their", found->first, found->second.size(),
                                  one ? kMaxSubstitutedBytes : kMaxTotalSubstitutedBytes));
        return std::nullopt;
      }
    }
    result += text.substr(at);
    return result;
  }

  void check_defines() {
    const std::vector<std::string> known(used_.begin(), used_.end());
    for (const auto& [name, value] : options_.defines) {
      if (used_.contains(name)) continue;
      diagnostics_.error({}, fmt::format("-D {}={}: the scene uses no ${}{}", name, value, name,
                                         known_names(name, known, "It uses")));
    }
  }

  const ReadOptions& options_;
  const FileAccess& access_;
  Diagnostics& diagnostics_;
  const XmlDialect* dialect_;
  const ElementReader::Substitute substitute_ = [this](std::string_view text, SourceLocation location) {
    return substitute(text, location);
  };
  ObjectTree tree_;
  std::vector<fs::path> including_;  ///< the files being read, the outermost first
  std::uint64_t total_bytes_ = 0;
  std::size_t substituted_bytes_ = 0;
  std::map<std::string, std::string> variables_;
  std::set<std::string> used_;
  std::vector<Alias> aliases_;
};

}  // namespace

ObjectTree read_object_tree(const fs::path& file, const ReadOptions& options, const FileAccess& files,
                            Diagnostics& diagnostics, const XmlDialect* dialect) {
  return XmlReader(options, files, diagnostics, dialect).read(file);
}

}  // namespace penumbra::mitsuba
