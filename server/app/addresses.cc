// SPDX-License-Identifier: MIT
#include "server/app/addresses.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <array>
#include <utility>

#include "server/net/listener.h"

namespace coopdyn {

std::vector<std::string> Addresses(const std::vector<std::string>& hosts) {
  if (hosts.empty()) return ListenAddresses("");
  std::vector<std::string> addresses;
  for (const std::string& host : hosts) {
    const bool wildcard = host == "0.0.0.0" || host == "::" || host == "any";
    if (wildcard) return ListenAddresses(host);  // includes all others
    for (std::string& address : ListenAddresses(host)) {
      if (std::find(addresses.begin(), addresses.end(), address) == addresses.end()) {
        addresses.push_back(std::move(address));
      }
    }
  }
  return addresses;
}

std::string LanAddress() {
  ifaddrs* found = nullptr;
  if (::getifaddrs(&found) != 0) return {};
  std::string address;
  for (const ifaddrs* one = found; one != nullptr && address.empty(); one = one->ifa_next) {
    const bool usable = one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET &&
                        (one->ifa_flags & IFF_LOOPBACK) == 0 && (one->ifa_flags & IFF_UP) != 0;
    if (!usable) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* ip = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
    if (::inet_ntop(AF_INET, &ip->sin_addr, text.data(), text.size()) != nullptr) address = text.data();
  }
  ::freeifaddrs(found);
  return address;
}

std::string WithAdvice(const std::string& error, const char* flags) {
  if (error.empty()) return error;
  if (error.find("in use") != std::string::npos) {
    return error + ": choose another block of ports with " + flags;
  }
  if (error.find("assign requested address") != std::string::npos) {
    return error +
           ": this machine has no such address: leave --host out, or write --host 0.0.0.0 for all that it "
           "has";
  }
  if (error.find("Too many open files") != std::string::npos)
    return error + (error.find("ulimit") == std::string::npos ? ": raise 'ulimit -n'" : "");
  return error + ": --host takes an address of this machine, e.g. --host 0.0.0.0 for all that it has";
}

std::string Bracketed(const std::string& host) {
  return host.find(':') == std::string::npos ? host : '[' + host + ']';
}

}  // namespace coopdyn
