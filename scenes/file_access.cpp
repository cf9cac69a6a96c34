#include "scenes/file_access.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "kernels/host/plain_file.h"
#include "scenes/inflated_stream.h"
#include "scenes/names.h"

namespace penumbra {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxFileNameBytes = 4096;  // PATH_MAX of Linux

/// Removes the byte order mark of UTF-8. Errors: the byte order mark of another encoding.
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

/// Decompresses gzip data.
Expected<std::string> unpacked(const std::string& packed, std::uint64_t max_bytes) {
  using State = InflatedStream::State;
  InflatedStream stream(packed, InflatedStream::Format::kGzip);
  std::string result;
  std::vector<char> part(std::size_t{1} << 20);
  while (stream.state() == State::kMore && result.size() <= max_bytes)
    result.append(part.data(), stream.read(part.data(), part.size()));
  if (stream.state() == State::kNoMemory) return fail("cannot be unpacked: no memory");
  if (result.size() > max_bytes) return fail(fmt::format("unpacks to more than {} bytes", max_bytes));
  if (stream.state() != State::kEnd) return fail("is damaged or ends early: it cannot be unpacked");
  return result;
}

constexpr std::string_view kLfsPointer = "version https://git-lfs.github.com/spec/";

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
  // Ignore an empty last component (a trailing slash).
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
  if (const auto found = find_nearly(name, candidates)) return *found;
  if (outside) {
    return fail(fmt::format("'{}' leads outside the folder that this scene is confined to, '{}'", name,
                            root_->string()));
  }
  return fail(fmt::format("there is no file '{}'; looked in: {}", name, list_names(places)));
}

const std::map<std::string, fs::path>& FileAccess::entries(const fs::path& folder) const {
  const auto [at, is_new] = entries_.try_emplace(folder);
  if (!is_new || !allows(folder)) return at->second;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(
           folder.empty() ? "." : folder, fs::directory_options::skip_permission_denied, ignored)) {
    const fs::path name = entry.path().filename();
    const auto [known, first] = at->second.try_emplace(to_lower_case(name.string()), name);
    if (!first && name < known->second) known->second = name;
  }
  return at->second;
}

std::optional<fs::path> FileAccess::find_in_any_case(const fs::path& path) const {
  std::error_code ignored;
  fs::path found;
  for (const fs::path& part : path) {
    if (fs::path exact = found / part; fs::exists(exact, ignored)) {
      found = std::move(exact);
      continue;
    }
    const auto& names = entries(found);
    const auto alike = names.find(to_lower_case(part.string()));
    if (alike == names.end()) return std::nullopt;
    found /= alike->second;
    if (!allows(found)) return std::nullopt;
  }
  return found;
}

std::optional<fs::path> FileAccess::find_nearly(std::string_view name,
                                                const std::vector<fs::path>& candidates) const {
  for (const fs::path& candidate : candidates) {
    std::string path = candidate.string();
    std::ranges::replace(path, '\\', '/');
    const fs::path plain = fs::path(path).lexically_normal();
    if (!allows(plain)) continue;
    const auto found = find_in_any_case(plain);
    if (!found) continue;
    std::string remark =
        fmt::format("'{}' is found as '{}': names of files are written with / and keep the case of letters",
                    name, found->string());
    if (said_.insert(remark).second) remarks_.push_back(std::move(remark));
    return found;
  }
  return std::nullopt;
}

Expected<std::string> FileAccess::read_bytes(const fs::path& file, std::uint64_t max_bytes) const {
  if (!allows(file)) {
    return fail(fmt::format("'{}' is outside the folder that this scene is confined to, '{}'", file.string(),
                            root_->string()));
  }
  Expected<std::string> bytes = read_plain_file(file, max_bytes);
  if (!bytes) return bytes;
  if (bytes->starts_with(kLfsPointer))
    return fail(fmt::format("'{}' is a pointer of Git LFS, not the file itself: `git lfs pull` brings that",
                            file.string()));
  if (bytes->starts_with("\x1f\x8b")) {
    bytes = unpacked(*bytes, max_bytes);
    if (!bytes) return fail(fmt::format("'{}' {}", file.string(), bytes.error().message));
  }
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
