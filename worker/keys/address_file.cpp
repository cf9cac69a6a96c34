#include "worker/keys/address_file.h"

#include <fmt/format.h>

#include <string_view>

#include "kernels/host/atomic_file.h"
#include "kernels/host/plain_file.h"
#include "worker/keys/tcp_address.h"

namespace penumbra {
namespace {

constexpr std::string_view kFilePrefix = "file:", kUnixPrefix = "unix:", kEnded = "ended";
constexpr std::uint64_t kMostAddressBytes = 4096;

}  // namespace

std::filesystem::path address_file_of(const std::string& address) {
  return address.starts_with(kFilePrefix) ? address.substr(kFilePrefix.size()) : std::string();
}

Expected<void> write_address_file(const std::filesystem::path& file, const std::string& address) {
  return write_file_atomically(file, bytes_of(address + "\n"));
}

Expected<void> end_address_file(const std::filesystem::path& file, bool comes_back) {
  if (!comes_back) return write_file_atomically(file, bytes_of(std::string(kEnded) + "\n"));
  std::error_code failed;
  std::filesystem::remove(file, failed);
  if (failed) return fail(fmt::format("cannot remove {}: {}", file.string(), failed.message()));
  return {};
}

Expected<std::optional<std::string>> read_address_file(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored))
    return fail(fmt::format("there is no file {}, in which a scheduler gives its address", file.string()));
  auto text = read_plain_file(file, kMostAddressBytes);
  if (!text) return std::unexpected(text.error());
  if (text->ends_with('\n')) text->pop_back();
  if (*text == kEnded) return std::optional<std::string>();
  const bool is_unix = text->starts_with(kUnixPrefix) && text->size() > kUnixPrefix.size();
  const auto [host, port] = split_address(*text);
  if (text->find('\n') != std::string::npos || (!is_unix && (host.empty() || !is_port(port))))
    return fail(fmt::format("{} contains no address of a scheduler", file.string()));
  return std::optional(*text);
}

}  // namespace penumbra
