#include "scheduler/render/frame_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/number.h"
#include "scheduler/render/frames.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostDigits = 20;

/// The place of a field in a name.
struct Field {
  std::size_t begin = 0, end = 0;
  std::size_t digits = 1;
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Reads "04" at `at`, or nothing, which is one digit, and then `close`. Nothing if there is something else.
std::optional<Field> width_at(std::string_view name, std::size_t begin, std::size_t at, char close) {
  const std::size_t end = name.find_first_not_of("0123456789", at);
  if (end == name.npos || name[end] != close) return std::nullopt;
  if (end == at) return Field{begin, end + 1, 1};
  const auto digits = parse_integer(name.substr(at, end - at), 1, kMostDigits);
  if (!digits || name[at] != '0') return std::nullopt;
  return Field{begin, end + 1, std::size_t(*digits)};
}

std::optional<Field> field_at(std::string_view name, std::size_t at) {
  constexpr std::string_view kFrame = "{frame";
  const std::string_view rest = name.substr(at);
  if (rest.starts_with('#')) {
    const std::size_t end = std::min(name.find_first_not_of('#', at), name.size());
    return Field{at, end, end - at};
  }
  if (rest.starts_with('%')) return width_at(name, at, at + 1, 'd');
  if (!rest.starts_with(kFrame)) return std::nullopt;
  const std::size_t next = at + kFrame.size();
  if (next < name.size() && name[next] == '}') return Field{at, next + 1, 1};
  if (next >= name.size() || name[next] != ':') return std::nullopt;
  return width_at(name, at, next + 1, '}');
}

/// The fields of a name, from left to right.
std::vector<Field> fields_of(std::string_view name) {
  std::vector<Field> fields;
  for (std::size_t at = 0; at < name.size();) {
    const auto field = field_at(name, at);
    if (field) fields.push_back(*field);
    at = field ? field->end : at + 1;
  }
  return fields;
}

}  // namespace

std::optional<FrameFiles> FrameFiles::of(std::string_view name) {
  const std::vector<Field> fields = fields_of(name);
  if (fields.empty()) return std::nullopt;
  const Field& last = fields.back();
  return FrameFiles(std::string(name.substr(0, last.begin)), std::string(name.substr(last.end)), last.digits);
}

std::optional<FrameFiles> FrameFiles::unless_file(const std::string& name) {
  std::error_code ignored;
  return fs::exists(name, ignored) ? std::nullopt : of(name);
}

fs::path FrameFiles::file(int frame) const {
  return fmt::format("{}{:0{}}{}", before_, frame, digits_, after_);
}

std::optional<int> FrameFiles::frame_of(const fs::path& file) const {
  const std::string name = file.string();
  if (name.size() <= before_.size() + after_.size() || !name.starts_with(before_) || !name.ends_with(after_))
    return std::nullopt;
  const std::string_view number =
      std::string_view(name).substr(before_.size(), name.size() - before_.size() - after_.size());
  if (!std::ranges::all_of(number, is_digit)) return std::nullopt;
  const auto frame = parse_integer(number, 0, kLastFrame);
  // "shot.00012.exr" is no file of shot.####.exr.
  if (!frame || fmt::format("{:0{}}", *frame, digits_) != number) return std::nullopt;
  return int(*frame);
}

fs::path FrameFiles::folder() const {
  const std::size_t slash = before_.rfind('/');
  return slash == before_.npos ? fs::path(".") : fs::path(before_.substr(0, slash + 1));
}

std::vector<int> FrameFiles::find() const {
  const std::size_t slash = before_.rfind('/');
  const std::string start = slash == before_.npos ? "" : before_.substr(0, slash + 1);
  const std::string rest = after_.substr(std::min(after_.find('/'), after_.size()));
  std::vector<int> frames;
  std::error_code error;
  for (fs::directory_iterator entry(folder(), error), end; !error && entry != end; entry.increment(error)) {
    const std::string path = start + entry->path().filename().string() + rest;
    std::error_code ignored;
    if (const auto frame = frame_of(path); frame && fs::is_regular_file(path, ignored))
      frames.push_back(*frame);
  }
  std::ranges::sort(frames);
  return frames;
}

fs::path FrameFiles::without_field() const {
  constexpr std::string_view kSeparators = "._- ";
  std::string before = before_, after = after_;
  const auto is_separator = [&](char c) { return kSeparators.find(c) != kSeparators.npos; };
  if (!before.empty() && is_separator(before.back()))
    before.pop_back();
  else if ((before.empty() || before.back() == '/') && !after.empty() && is_separator(after.front()) &&
           after.find('.', 1) != after.npos)
    after.erase(0, 1);  // "0001_beauty.exr": the separator follows
  if ((before.empty() || before.back() == '/') && after.starts_with('/')) after.erase(0, 1);
  return before + after;
}

std::string with_hashes(std::string name) {
  std::vector<Field> fields = fields_of(name);
  for (auto field = fields.rbegin(); field != fields.rend(); ++field)
    if (name[field->begin] == '{')
      name.replace(field->begin, field->end - field->begin, std::string(field->digits, '#'));
  return name;
}

}  // namespace penumbra
