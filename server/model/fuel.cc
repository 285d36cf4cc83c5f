// SPDX-License-Identifier: MIT
#include "server/model/fuel.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "server/base/words.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr std::array kHosts = {"fuel.gazebosim.org", "fuel.ignitionrobotics.org"};

/// Percent-decodes `text`.
std::string Decoded(const std::string& text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char code = 0;
    const char *begin = text.data() + i + 1, *end = begin + 2;
    if (text[i] == '%' && i + 2 < text.size() && std::from_chars(begin, end, code, 16).ptr == end) {
      decoded += static_cast<char>(code);
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

bool IsNumber(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/// The folder `name` in `folder`, case-insensitively; the first one if there are several.
std::optional<fs::path> Child(const fs::path& folder, const std::string& name) {
  std::optional<fs::path> found;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    if (ToLower(it->path().filename().string()) == ToLower(name) && (!found || it->path() < *found))
      found = it->path();
  }
  return found;
}

/// The folder of the requested version of a model, or of the newest.
std::optional<fs::path> VersionIn(const fs::path& model, const std::string& version) {
  if (!version.empty()) return Child(model, version);
  std::optional<fs::path> newest;
  const auto less = [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  };
  std::error_code code;
  for (fs::directory_iterator it(model, code), end; !code && it != end; it.increment(code)) {
    const std::string number = it->path().filename().string();
    if (IsNumber(number) && (!newest || less(newest->filename().string(), number))) newest = it->path();
  }
  return newest;
}

}  // namespace

std::optional<FuelAddress> FuelAddressOf(const std::string& uri) {
  const std::string lower = ToLower(uri);
  std::size_t at = std::string::npos;
  for (const char* scheme : {"https://", "http://"}) {
    for (const char* host : kHosts) {
      const std::string start = std::string(scheme) + host + "/";
      if (lower.starts_with(start)) at = start.size();
    }
  }
  if (at == std::string::npos) return std::nullopt;
  std::vector<std::string> words;
  std::vector<std::size_t> ends;  // end of each word in `uri`
  while (at < uri.size()) {
    const std::size_t end = std::min(uri.find('/', at), uri.size());
    if (end > at) {
      words.push_back(Decoded(uri.substr(at, end - at)));
      ends.push_back(end);
    }
    at = end + 1;
  }
  // Older programs include the server's version.
  std::size_t next = !words.empty() && words.front().find_first_not_of("0123456789.") == std::string::npos;
  if (words.size() < next + 3 || ToLower(words[next + 1]) != "models") return std::nullopt;
  FuelAddress address;
  address.owner = words[next];
  address.name = words[next + 2];
  std::size_t last = next + 2;
  next += 3;
  if (next < words.size() && (IsNumber(words[next]) || words[next] == "tip")) {
    if (words[next] != "tip") address.version = words[next];
    last = next++;
  }
  if (next < words.size() && words[next] == "files") ++next;
  for (; next < words.size(); ++next) address.file /= words[next];
  address.url = uri.substr(0, ends[last]);
  return address;
}

std::optional<fs::path> FuelFolderIn(const fs::path& cache, const FuelAddress& address) {
  for (const char* host : kHosts) {
    auto folder = Child(cache / host, address.owner);
    if (folder) folder = Child(*folder / "models", address.name);
    if (folder) folder = VersionIn(*folder, address.version);
    if (folder) return folder;
  }
  return std::nullopt;
}

}  // namespace coopdyn
