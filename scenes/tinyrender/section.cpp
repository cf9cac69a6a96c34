#include "scenes/tinyrender/section.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/settings.h"

namespace penumbra::tinyrender {

void Context::unknown(SourceLocation location, std::string_view message, std::string_view instead) const {
  if (lenient) {
    diagnostics.warn(location, fmt::format("{}; {}", message, instead));
  } else {
    diagnostics.error(location, message);
  }
}

Section::Section(const Context& context, std::string_view name) : context_(context), name_(name) {
  const auto& tables = context.document.tables;
  const auto found = std::ranges::find(tables, name, &Table::name);
  if (found != tables.end()) {
    table_ = &*found;
  } else {
    context.diagnostics.error({&context.file, 0}, fmt::format("the scene has no [{}]", name));
  }
}

const Entry* Section::find(std::string_view key) const {
  if (table_ == nullptr) return nullptr;
  const auto found = std::ranges::find(table_->entries, key, &Entry::key);
  return found != table_->entries.end() ? &*found : nullptr;
}

const Entry* Section::take(std::string_view key) {
  if (std::ranges::find(known_, key) == known_.end()) known_.emplace_back(key);
  return find(key);
}

bool Section::has(std::string_view key) const { return find(key) != nullptr; }

SourceLocation Section::location(std::string_view key) const {
  if (const Entry* entry = find(key)) return entry->value_location;
  return table_ != nullptr ? table_->location : SourceLocation{&context_.file, 0};
}

void Section::wrong(std::string_view key, std::string_view message) const {
  context_.diagnostics.error(location(key), message);
}

void Section::warn(std::string_view key, std::string_view message) const {
  context_.diagnostics.warn(location(key), message);
}

void Section::wrong_kind(const Entry& entry, std::string_view wanted) const {
  context_.diagnostics.error(entry.value_location, fmt::format("[{}] {} must be {}, not {}", name_, entry.key,
                                                               wanted, describe_kind(entry.value)));
}

bool Section::boolean(std::string_view key, bool fallback) {
  const Entry* entry = take(key);
  if (entry == nullptr) return fallback;
  if (const bool* value = std::get_if<bool>(&entry->value)) return *value;
  wrong_kind(*entry, "true or false");
  return fallback;
}

std::optional<std::string> Section::text(std::string_view key) {
  const Entry* entry = take(key);
  if (entry == nullptr) return std::nullopt;
  if (const auto* value = std::get_if<std::string>(&entry->value)) return *value;
  wrong_kind(*entry, "text");
  return std::nullopt;
}

std::optional<std::int64_t> Section::integer(std::string_view key) {
  const Entry* entry = take(key);
  if (entry == nullptr) return std::nullopt;
  if (const auto* value = std::get_if<std::int64_t>(&entry->value)) return *value;
  wrong_kind(*entry, "an integer");
  return std::nullopt;
}

std::optional<std::string> Section::vector(std::string_view key) {
  const Entry* entry = take(key);
  if (entry == nullptr) return std::nullopt;
  const auto* values = std::get_if<std::vector<double>>(&entry->value);
  if (values == nullptr) {
    wrong_kind(*entry, "an array of 3 numbers");
  } else if (values->size() != 3) {
    wrong(key, fmt::format("[{}] {} takes 3 numbers, not {}", name_, key, values->size()));
  } else {
    return entry->text;
  }
  return std::nullopt;
}

bool Section::set(SceneDescription& scene, std::string_view setting, std::string_view key) {
  const Entry* entry = take(key);
  if (entry == nullptr) return false;
  const bool is_integer = std::holds_alternative<std::int64_t>(entry->value);
  const bool is_number = is_integer || std::holds_alternative<double>(entry->value);
  const Setting* found = find_setting(setting);
  if (found == nullptr) return false;
  switch (found->kind) {
    case SettingKind::kInteger:
      if (!is_integer) return wrong_kind(*entry, "an integer"), true;
      break;
    case SettingKind::kNumber:
      if (!is_number) return wrong_kind(*entry, "a number"), true;
      break;
    case SettingKind::kBoolean:
      if (!std::holds_alternative<bool>(entry->value)) return wrong_kind(*entry, "true or false"), true;
      break;
    case SettingKind::kText:  // no key of a scene is of this kind alone
    case SettingKind::kNumberOrText:
      if (!is_number && !std::holds_alternative<std::string>(entry->value))
        return wrong_kind(*entry, "a number or text"), true;
      break;
  }
  if (const auto done = found->apply(scene, entry->text); !done)
    wrong(key, fmt::format("[{}] {}: {}", name_, key, done.error().message));
  return true;
}

void Section::imply(SceneDescription& scene, std::string_view setting, std::string_view value,
                    std::string_view key) const {
  if (const auto done = apply_setting(scene, setting, value); !done) wrong(key, done.error().message);
}

void Section::require(std::string_view key) const {
  if (table_ != nullptr && !has(key)) wrong("", fmt::format("[{}] needs '{}'", name_, key));
}

void Section::finish(std::span<const std::string> elsewhere, std::string_view where) {
  if (table_ == nullptr) return;
  std::vector<std::string> all = known_;
  all.insert(all.end(), elsewhere.begin(), elsewhere.end());
  for (const Entry& entry : table_->entries) {
    if (std::ranges::find(known_, entry.key) != known_.end()) continue;
    if (std::ranges::find(elsewhere, entry.key) != elsewhere.end()) {
      context_.diagnostics.warn(entry.key_location, fmt::format("{} has no effect {}", entry.key, where));
      continue;
    }
    context_.unknown(
        entry.key_location,
        fmt::format("[{}] has no key '{}'{}", name_, entry.key, known_names(entry.key, all, "It has")),
        "it is left out");
  }
}

}  // namespace penumbra::tinyrender
