// Reading one table of a TinyRender scene: each key must be requested, so that an unknown one is an error.
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

  /// An error, or with `lenient` a warning that ends in `instead`, "it is left out" for example.
  void unknown(SourceLocation location, std::string_view message, std::string_view instead) const;
};

class Section {
 public:
  /// The table of that name; without one, an error, and a section that has nothing.
  Section(const Context& context, std::string_view name);

  [[nodiscard]] bool has(std::string_view key) const;

  /// The value, or `fallback` where the key is not given; an error where it is of another kind.
  bool boolean(std::string_view key, bool fallback);
  std::optional<std::string> text(std::string_view key);
  std::optional<std::int64_t> integer(std::string_view key);
  /// Three numbers.
  std::optional<std::string> vector(std::string_view key);

  /// Sets `setting` (see settings.h) from the key. Returns whether it is given.
  bool set(SceneDescription& scene, std::string_view setting, std::string_view key);

  /// Sets it to what the scene's format implies. An error is one of the key, if it is given.
  void imply(SceneDescription& scene, std::string_view setting, std::string_view value,
             std::string_view key = "") const;

  /// An error if the key is not given.
  void require(std::string_view key) const;

  /// Known, but without effect on the image.
  void accept(std::string_view key) { take(key); }

  /// Reports keys that were not requested: those among `elsewhere` have no effect `where` ("with method =
  /// area"), and the others are unknown.
  void finish(std::span<const std::string> elsewhere = {}, std::string_view where = "");

  /// At the key's value, or at the table if it is not given.
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
