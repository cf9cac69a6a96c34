#include "scenes/tinyrender/mtl_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "scenes/names.h"
#include "scenes/number.h"
#include "scenes/statement_scanner.h"

namespace penumbra::tinyrender {
namespace {

using Names = std::vector<std::string>;

const Names kRead = {"newmtl", "Kd", "Ks", "Ke", "Ns", "illum"};
/// Without effect on what TinyRender's surfaces look like.
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
      diagnostics_.warn(location, fmt::format("{}: textures are not read; the plain colours count", keyword));
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
    if (keyword == "Ns") {
      if (const auto numbers = read_numbers(keyword, 1); !numbers.empty()) material_->exponent = numbers[0];
      return;
    }
    const std::vector<float> v = read_numbers(keyword, 3);
    if (v.empty()) return;
    auto& target = keyword == "Kd"   ? material_->diffuse
                   : keyword == "Ks" ? material_->specular
                                     : material_->emission;
    // One number is a grey, as MTL has it.
    target = v.size() == 1 ? glm::vec3(v[0]) : glm::vec3(v[0], v[1], v[2]);
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

  /// 1 or `most` numbers; none, and an error, where there is anything else. MTL's "spectral" and "xyz" are no
  /// numbers.
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
  MtlMaterial ignored_;  ///< takes what belongs to a material that does not count
};

}  // namespace

void read_mtl(const SourceFile& file, MtlMaterials& materials, Diagnostics& diagnostics) {
  MtlReader(file, materials, diagnostics).read();
}

}  // namespace penumbra::tinyrender
