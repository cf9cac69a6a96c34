#include "scenes/file_access.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <vector>

namespace penumbra {

namespace fs = std::filesystem;

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

Expected<std::unique_ptr<SourceFile>> FileAccess::read(const fs::path& file, std::uint64_t max_bytes) const {
  if (!allows(file)) {
    return fail(fmt::format("'{}' is outside the folder that this scene is confined to, '{}'", file.string(),
                            root_->string()));
  }
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  if (!fs::exists(status)) return fail(fmt::format("there is no file '{}'", file.string()));
  // Reading a device or a pipe might never end.
  if (!fs::is_regular_file(status)) return fail(fmt::format("'{}' is not a plain file", file.string()));
  const std::uint64_t size = fs::file_size(file, code);
  if (code) return fail(fmt::format("cannot read '{}': {}", file.string(), code.message()));
  if (size > max_bytes) {
    return fail(
        fmt::format("'{}' has {} bytes; the most that is read is {}", file.string(), size, max_bytes));
  }
  auto result = std::make_unique<SourceFile>();
  result->path = file;
  result->text.resize(size);
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(result->text.data(), std::streamsize(size)) || stream.gcount() != std::streamsize(size)) {
    return fail(fmt::format("cannot read '{}'", file.string()));
  }
  files_read_.push_back(file);
  return result;
}

}  // namespace penumbra
