#include "worker/keys/host_names.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>

#include <algorithm>

#include "kernels/host/process.h"
#include "worker/keys/certificate.h"

namespace penumbra {
namespace {

void add(std::vector<std::string>& names, const std::string& name) {
  if (is_certificate_name(name) && std::ranges::find(names, name) == names.end()) names.push_back(name);
}

std::string address_text(const sockaddr* address) {
  char text[INET6_ADDRSTRLEN] = "";
  if (address == nullptr) return "";
  if (address->sa_family == AF_INET)
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text, sizeof text);
  if (address->sa_family == AF_INET6) {
    const in6_addr& six = reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr;
    if (!IN6_IS_ADDR_LINKLOCAL(&six)) inet_ntop(AF_INET6, &six, text, sizeof text);
  }
  return text;
}

}  // namespace

std::vector<std::string> loopback_names() { return {"localhost", "127.0.0.1", "::1"}; }

std::vector<std::string> host_names() {
  std::vector<std::string> names;
  const std::string own = host_name();
  add(names, own);
  add(names, own.substr(0, own.find('.')));
  addrinfo hints{};
  hints.ai_flags = AI_CANONNAME;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(own.c_str(), nullptr, &hints, &found) == 0) {
    if (found != nullptr && found->ai_canonname != nullptr) add(names, found->ai_canonname);
    freeaddrinfo(found);
  }
  ifaddrs* interfaces = nullptr;
  if (getifaddrs(&interfaces) == 0) {
    for (const ifaddrs* at = interfaces; at != nullptr; at = at->ifa_next)
      if ((at->ifa_flags & IFF_UP) != 0 && (at->ifa_flags & IFF_LOOPBACK) == 0)
        add(names, address_text(at->ifa_addr));
    freeifaddrs(interfaces);
  }
  return names;
}

}  // namespace penumbra
