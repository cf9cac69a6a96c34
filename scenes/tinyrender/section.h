// Reads one table of a TinyRender scene. Every key must be requested, so that unknown keys are detected.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene_description.h"
#include "scenes/tinyrender/toml_document.h"

namespace penumbra::tinyrender {

/// What the readers of the tables share.
struct Context {
  const SourceFile& file;
  const Document& document;
  Diagnostics& diagnostics;
  bool lenient = false;

  /// Reports something unknown: an error, or with `lenient` a warning that ends in `instead`, "it is left
  /// out" for example.
  void unknown(SourceLocation location, std::string_view message, std::string_view instead) const;
};

class Section {
 public:
  /// The table of that name. If it is missing, an error and an empty section.
  Section(const Context& context, std::string_view name);

  [[nodiscard]] bool has(std::string_view key) const;

  /// The value of the key, or `fallback` if it is not given. It is an error if it has another type.
  bool boolean(std::string_view key, bool fallback);
  std::optional<std::string> text(std::string_view key);
  std::optional<std::int64_t> integer(std::string_view key);
  /// Three numbers, as the text of a setting.
  std::optional<std::string> vector(std::string_view key);

  /// Sets the setting `setting` (see settings.h) from the key. Returns whether the key is given.
  bool set(SceneDescription& scene, std::string_view setting, std::string_view key);

  /// Sets a setting to the value that the scene's format implies. Errors are reported at the key, if it is
  /// given.
  void imply(SceneDescription& scene, std::string_view setting, std::string_view value,
             std::string_view key = "") const;

  /// Reports an error if the key is not given.
  void require(std::string_view key) const;

  /// Accepts a key that has no effect on the image.
  void accept(std::string_view key) { take(key); }

  /// Reports keys that were not requested. Those in `elsewhere` have no effect `where` ("with method =
  /// area"); all others are unknown.
  void finish(std::span<const std::string> elsewhere = {}, std::string_view where = "");

  /// Reports an error at the key's value, or at the table if the key is not given.
  void wrong(std::string_view key, std::string_view message) const;
  void warn(std::string_view key, std::string_view message) const;
  [[nodiscard]] SourceLocation location(std::string_view key) const;

 private:
  const Entry* find(std::string_view key) const;
  const Entry* take(std::string_view key);
  void wrong_kind(const Entry& entry, std::string_view wanted) const;

  const Context& context_;
  std::string name_;
  const Table* table_ = nullptr;
  std::vector<std::string> known_;
};

}  // namespace penumbra::tinyrender
