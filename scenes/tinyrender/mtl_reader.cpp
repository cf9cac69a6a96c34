#include "scenes/tinyrender/mtl_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "scenes/names.h"
#include "scenes/number.h"
#include "scenes/statement_scanner.h"

namespace penumbra::tinyrender {
namespace {

using Names = std::vector<std::string>;

const Names kRead = {"newmtl", "Kd", "Ks", "Ke", "Ns", "illum", "map_Kd", "map_Ks", "map_Ns"};
/// Statements that have no effect in TinyRender.
const Names kIgnored = {"Ka", "Ni", "d",  "Tr", "Tf",  "sharpness", "Km",
                        "Pr", "Pm", "Ps", "Pc", "Pcr", "aniso",     "anisor"};
const Names kTextures = {"bump", "disp", "decal", "refl", "norm"};

class MtlReader {
 public:
  MtlReader(const SourceFile& file, MtlMaterials& materials, Diagnostics& diagnostics)
      : scanner_(file), materials_(materials), diagnostics_(diagnostics) {}

  void read() {
    for (; !scanner_.at_end() && !diagnostics_.full(); scanner_.next()) {
      const std::string_view keyword = scanner_.token();
      if (!keyword.empty()) statement(keyword);
    }
  }

 private:
  void statement(std::string_view keyword) {
    const SourceLocation location = scanner_.location();
    if (keyword == "newmtl") {
      begin();
    } else if (std::ranges::find(kRead, keyword) != kRead.end()) {
      if (material_ == nullptr)
        return diagnostics_.error(location, fmt::format("{} before any newmtl", keyword));
      value(keyword);
    } else if (keyword.starts_with("map_") || std::ranges::find(kTextures, keyword) != kTextures.end()) {
      diagnostics_.warn(location, fmt::format("{}: this texture is not read; what is plain counts", keyword));
    } else if (std::ranges::find(kIgnored, keyword) == kIgnored.end()) {
      Names known = kRead;
      known.insert(known.end(), kIgnored.begin(), kIgnored.end());
      diagnostics_.warn(location, fmt::format("'{}' is not an MTL statement{}; it is left out",
                                              keyword.substr(0, 40), suggestion(keyword, known)));
    }
  }

  void begin() {
    const std::string name(scanner_.rest());
    const SourceLocation location = scanner_.location();
    material_ = &ignored_;
    if (name.empty()) return diagnostics_.error(location, "newmtl needs a name");
    if (const auto checked = check_name_length("name of a material", name); !checked)
      return diagnostics_.error(location, checked.error().message);
    const auto [entry, is_new] = materials_.try_emplace(name, MtlMaterial{.location = location});
    if (is_new) {
      material_ = &entry->second;
    } else {
      diagnostics_.warn(location, fmt::format("the material '{}' is there already, at {}; the first counts",
                                              name, describe(entry->second.location)));
    }
  }

  void value(std::string_view keyword) {
    if (keyword == "illum") return illum();
    if (keyword.starts_with("map_")) return map(keyword);
    if (keyword == "Ns") {
      if (const auto numbers = read_numbers(keyword, 1); !numbers.empty()) material_->exponent = numbers[0];
      return;
    }
    const std::vector<float> v = read_numbers(keyword, 3);
    if (v.empty()) return;
    auto& target = keyword == "Kd"   ? material_->diffuse
                   : keyword == "Ks" ? material_->specular
                                     : material_->emission;
    // A single number is grey, as in MTL.
    target = v.size() == 1 ? glm::vec3(v[0]) : glm::vec3(v[0], v[1], v[2]);
  }

  /// Reads a texture's options, then its file name.
  void map(std::string_view keyword) {
    MtlMap result;
    for (;;) {
      const std::string_view rest = scanner_.rest_of_line();
      if (rest.empty() || rest.front() != '-') break;
      const std::string_view option = scanner_.token();
      if (option == "-s" || option == "-o") {
        if (!pair(option, option == "-s" ? result.scale : result.offset)) return;
      } else if (option == "-clamp") {
        result.clamp = scanner_.token() == "on";
      } else if (const auto* ignored = ignored_option(option)) {
        for (int i = 0; i < ignored->arguments; ++i) scanner_.token();
        diagnostics_.warn(scanner_.location(), fmt::format("{}: the option {} is left out", keyword, option));
      } else {
        wrong(fmt::format("'{}' is not an option of {}; it has -s, -o, -clamp and others", option, keyword));
        return;
      }
    }
    result.name = scanner_.rest();
    result.location = scanner_.location();
    if (result.name.empty()) {
      wrong(fmt::format("{} needs the name of an image", keyword));
      return;
    }
    auto& target = keyword == "map_Kd"   ? material_->diffuse_map
                   : keyword == "map_Ks" ? material_->specular_map
                                         : material_->exponent_map;
    target = std::move(result);
  }

  struct IgnoredOption {
    std::string_view name;
    int arguments;
  };
  static const IgnoredOption* ignored_option(std::string_view name) {
    static constexpr IgnoredOption kOptions[] = {{"-blendu", 1}, {"-blendv", 1}, {"-bm", 1},
                                                 {"-boost", 1},  {"-cc", 1},     {"-imfchan", 1},
                                                 {"-mm", 2},     {"-texres", 1}, {"-type", 1}};
    const auto found = std::ranges::find(kOptions, name, &IgnoredOption::name);
    return found == std::end(kOptions) ? nullptr : found;
  }

  /// Reads one to three numbers; the third, for volumes, is ignored.
  bool pair(std::string_view option, glm::dvec2& target) {
    int count = 0;
    for (; count < 3; ++count) {
      const std::string_view next = scanner_.rest_of_line();
      const auto value = parse_number(next.substr(0, next.find_first_of(" \t")));
      if (!value || !std::isfinite(*value)) break;
      scanner_.token();
      if (count < 2) target[count] = *value;
    }
    if (count == 0) wrong(fmt::format("'{}' takes one to three numbers", option));
    return count > 0;
  }

  void illum() {
    const std::string_view text = scanner_.token();
    const auto number = parse_integer(text);
    if (!number) {
      wrong(fmt::format("'illum' takes the number of a reflection model: {}", number.error().message));
      return;
    }
    material_->illum = *number;
  }

  /// Reads 1 or `most` numbers. Nothing, and an error, otherwise. MTL's "spectral" and "xyz" are not
  /// supported.
  std::vector<float> read_numbers(std::string_view keyword, std::size_t most) {
    std::vector<float> values;
    for (std::string_view text = scanner_.token(); !text.empty(); text = scanner_.token()) {
      if (values.size() == most) return wrong(fmt::format("'{}' takes {}, not more", keyword, count(most)));
      const auto value = parse_number(text);
      if (!value) return wrong(value.error().message);
      if (!(*value >= 0.0 && *value <= double(std::numeric_limits<float>::max())))
        return wrong(fmt::format("'{}' must be 0 or more and finite, not {}", keyword, text));
      values.push_back(float(*value));
    }
    if (values.size() != 1 && values.size() != most)
      return wrong(fmt::format("'{}' takes {}, not {}", keyword, count(most), values.size()));
    return values;
  }

  static std::string count(std::size_t numbers) {
    return numbers == 1 ? "1 number" : fmt::format("{} numbers", numbers);
  }

  std::vector<float> wrong(std::string_view message) {
    diagnostics_.error(scanner_.location(), message);
    return {};
  }

  StatementScanner scanner_;
  MtlMaterials& materials_;
  Diagnostics& diagnostics_;
  MtlMaterial* material_ = nullptr;
  MtlMaterial ignored_;  ///< receives statements of a material that is ignored
};

}  // namespace

void read_mtl(const SourceFile& file, MtlMaterials& materials, Diagnostics& diagnostics) {
  MtlReader(file, materials, diagnostics).read();
}

}  // namespace penumbra::tinyrender
