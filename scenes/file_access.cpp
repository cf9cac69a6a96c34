#include "scenes/file_access.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "kernels/host/plain_file.h"

namespace penumbra {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxFileNameBytes = 4096;  // PATH_MAX of Linux

/// Takes the mark of UTF-8 away. Errors: text of another encoding that says so.
Expected<void> take_byte_order_mark(std::string& text) {
  const std::string_view start = std::string_view(text).substr(0, 4);
  using namespace std::string_view_literals;
  const char* encoding = start == "\0\0\xFE\xFF"sv || start == "\xFF\xFE\0\0"sv           ? "UTF-32"
                         : start.starts_with("\xFE\xFF") || start.starts_with("\xFF\xFE") ? "UTF-16"
                                                                                          : nullptr;
  if (encoding != nullptr) return fail(fmt::format("is {} text; save it as UTF-8", encoding));
  if (start.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  return {};
}

}  // namespace

FileAccess::FileAccess(std::optional<fs::path> confine_to) {
  if (!confine_to) return;
  std::error_code ignored;
  root_ = fs::weakly_canonical(fs::absolute(*confine_to, ignored), ignored);
}

bool FileAccess::allows(const fs::path& file) const {
  if (!root_) return true;
  std::error_code code;
  const fs::path real = fs::weakly_canonical(fs::absolute(file, code), code);
  if (code) return false;
  // An empty last component (a trailing slash) must not count.
  const fs::path root = root_->has_filename() ? *root_ : root_->parent_path();
  return std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first == root.end();
}

Expected<fs::path> FileAccess::find(std::string_view name, std::span<const fs::path> folders) const {
  if (name.empty()) return fail("the file name is empty");
  if (name.find('\0') != name.npos) return fail("the file name holds a NUL character");
  if (name.size() > kMaxFileNameBytes) {
    return fail(fmt::format("the file name has {} bytes; the most that are read are {}", name.size(),
                            kMaxFileNameBytes));
  }
  const fs::path file(name);
  std::vector<fs::path> candidates;
  if (file.is_absolute()) {
    candidates.push_back(file);
  } else {
    for (const fs::path& folder : folders) candidates.push_back(folder / file);
  }
  bool outside = false;
  std::vector<std::string> places;
  for (const fs::path& candidate : candidates) {
    if (!allows(candidate)) {
      outside = true;
      continue;
    }
    std::error_code ignored;
    if (fs::exists(candidate, ignored)) return candidate;
    const std::string place = candidate.parent_path().empty() ? "." : candidate.parent_path().string();
    if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
  }
  if (outside) {
    return fail(fmt::format("'{}' leads outside the folder that this scene is confined to, '{}'", name,
                            root_->string()));
  }
  return fail(fmt::format("there is no file '{}'; looked in: {}", name, list_names(places)));
}

Expected<std::string> FileAccess::read_bytes(const fs::path& file, std::uint64_t max_bytes) const {
  if (!allows(file)) {
    return fail(fmt::format("'{}' is outside the folder that this scene is confined to, '{}'", file.string(),
                            root_->string()));
  }
  Expected<std::string> bytes = read_plain_file(file, max_bytes);
  if (!bytes) return bytes;
  files_read_.push_back(file);
  contents_hash_ = XXH3_64bits_withSeed(bytes->data(), bytes->size(), contents_hash_);
  return bytes;
}

Expected<std::unique_ptr<SourceFile>> FileAccess::read(const fs::path& file, std::uint64_t max_bytes) const {
  Expected<std::string> text = read_bytes(file, max_bytes);
  if (!text) return std::unexpected(text.error());
  auto result = std::make_unique<SourceFile>();
  result->path = file;
  result->text = std::move(*text);
  if (const auto done = take_byte_order_mark(result->text); !done)
    return fail(fmt::format("'{}' {}", file.string(), done.error().message));
  return result;
}

}  // namespace penumbra
