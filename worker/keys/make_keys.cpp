#include "worker/keys/make_keys.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <span>

#include "kernels/host/plain_file.h"
#include "worker/keys/key_folder.h"
#include "worker/keys/secrets.h"

namespace penumbra {
namespace {

constexpr int kHoursOfDay = 24;
constexpr mode_t kOwnerOnly = S_IRUSR | S_IWUSR;

struct KeyFile {
  std::filesystem::path path;
  std::string text;
};

Error cannot_write(const std::filesystem::path& path) {
  return {fmt::format("cannot write {}: {}", path.string(), std::strerror(errno))};
}

/// Writes a temporary file first, so that the file is complete when it appears, and never readable for
/// others.
Expected<void> write_private(const KeyFile& file, bool may_replace) {
  const std::string aside = file.path.string() + ".new";
  unlink(aside.c_str());  // left by a process that was killed
  const int descriptor =
      open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kOwnerOnly);
  if (descriptor < 0) return std::unexpected(cannot_write(aside));
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(file.text.data()), file.text.size());
  bool is_written = fchmod(descriptor, kOwnerOnly) == 0 && write_whole(descriptor, bytes);
  is_written = is_written && fsync(descriptor) == 0;
  is_written = close(descriptor) == 0 && is_written;
  // Unlike a rename, a link never replaces a file.
  if (is_written)
    is_written = (may_replace ? rename(aside.c_str(), file.path.c_str())
                              : link(aside.c_str(), file.path.c_str())) == 0;
  const Error error = cannot_write(file.path);
  unlink(aside.c_str());
  return is_written ? Expected<void>() : std::unexpected(error);
}

Expected<void> make_private_folder(const std::filesystem::path& folder) {
  if (mkdir(folder.c_str(), S_IRWXU) == 0) return {};
  std::error_code ignored;
  if (errno == EEXIST && std::filesystem::is_directory(folder, ignored)) return {};
  return fail(fmt::format("cannot make the folder {}: {}", folder.string(), std::strerror(errno)));
}

Expected<std::vector<KeyFile>> compose(const MakeKeysOptions& options) {
  const std::chrono::seconds lifetime = std::chrono::hours(std::int64_t(kHoursOfDay) * options.days);
  // The name distinguishes it from other farms' in messages.
  const std::string name = "penumbra farm " + make_token().substr(0, 8);
  const auto authority = make_authority(name, {.until = 2 * lifetime});
  if (!authority) return std::unexpected(authority.error());
  std::vector<KeyFile> files{
      {options.folder / key_files::kAuthorityFolder / key_files::kCertificate, authority->certificate},
      {options.folder / key_files::kAuthorityFolder / key_files::kKey, authority->key}};
  const Tokens tokens{.watch = make_token(), .work = make_token(), .submit = make_token()};
  for (const KeyRoleInfo& role : kKeyRoles) {
    const bool is_server = role.use == CertificateUse::kServer;
    const auto pair =
        make_certificate(*authority, std::string("penumbra ") + role.folder, role.use,
                         is_server ? options.names : std::vector<std::string>(), {.until = lifetime});
    if (!pair) return std::unexpected(pair.error());
    const std::filesystem::path folder = options.folder / role.folder;
    files.push_back({folder / key_files::kAuthority, authority->certificate});
    files.push_back({folder / key_files::kCertificate, pair->certificate});
    files.push_back({folder / key_files::kKey, pair->key});
    for (const TokenKind& kind : kTokenKinds)
      if (has_token(role, kind))
        files.push_back({folder / key_files::token(kind.name), tokens.*kind.token + "\n"});
  }
  return files;
}

}  // namespace

Expected<void> make_keys(const MakeKeysOptions& options) {
  keep_out_of_core_dumps();
  const auto files = compose(options);
  if (!files) return std::unexpected(files.error());
  for (const KeyFile& file : *files) {
    struct stat status {};
    if (!options.force && lstat(file.path.c_str(), &status) == 0)
      return fail(
          fmt::format("{} is there already: give another folder, or --force for new keys, after which all "
                      "machines need them",
                      file.path.string()));
  }
  if (const auto made = make_private_folder(options.folder); !made) return made;
  for (const KeyFile& file : *files) {
    if (const auto made = make_private_folder(file.path.parent_path()); !made) return made;
    if (const auto written = write_private(file, options.force); !written) return written;
  }
  return {};
}

}  // namespace penumbra
