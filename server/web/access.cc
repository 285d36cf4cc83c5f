// SPDX-License-Identifier: MIT
#include "server/web/access.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>

#include "protocol/ascii.h"

namespace coopdyn {
namespace {

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), ToLower);
  return lower;
}

bool IsAddress(const std::string& name) {
  std::array<unsigned char, sizeof(in6_addr)> bytes;
  return inet_pton(AF_INET, name.c_str(), bytes.data()) == 1 ||
         inet_pton(AF_INET6, name.c_str(), bytes.data()) == 1;
}

bool IsPort(std::string_view text) {
  return !text.empty() && text.size() <= 5 && std::all_of(text.begin(), text.end(), IsDigit);
}

bool IsNameCharacter(char c) {
  return IsDigit(c) || IsLower(c) || IsUpper(c) || c == '-' || c == '_' || c == '.';
}

}  // namespace

std::optional<std::string> HostName(std::string_view host) {
  std::string_view name = host;
  std::string_view rest;
  if (host.starts_with('[')) {
    const auto end = host.find(']');
    if (end == std::string_view::npos) return std::nullopt;
    name = host.substr(1, end - 1);
    rest = host.substr(end + 1);
    std::array<unsigned char, sizeof(in6_addr)> bytes;
    if (inet_pton(AF_INET6, std::string(name).c_str(), bytes.data()) != 1) return std::nullopt;
  } else {
    const auto colon = host.find(':');
    if (colon != std::string_view::npos) {
      name = host.substr(0, colon);
      rest = host.substr(colon);
    }
    if (name.empty() || !std::all_of(name.begin(), name.end(), IsNameCharacter)) return std::nullopt;
  }
  if (!rest.empty() && !(rest.front() == ':' && IsPort(rest.substr(1)))) return std::nullopt;
  return Lower(name);
}

bool HostAllowed(std::string_view host, const std::vector<std::string>& names) {
  const std::optional<std::string> name = HostName(host);
  if (!name) return false;
  if (*name == "localhost" || IsAddress(*name)) return true;
  return std::any_of(names.begin(), names.end(), [&](const std::string& own) { return Lower(own) == *name; });
}

bool OriginAllowed(std::string_view origin, std::string_view host) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme)) return Lower(origin.substr(scheme.size())) == Lower(host);
  }
  return false;
}

std::string_view BearerToken(std::string_view authorization) {
  constexpr std::string_view kScheme = "bearer ";
  if (Lower(authorization.substr(0, kScheme.size())) != kScheme) return {};
  return authorization.substr(kScheme.size());
}

}  // namespace coopdyn
