// SPDX-License-Identifier: MIT
#include "server/naming/yarp_conf.h"

#include <algorithm>
#include <sstream>

namespace coopdyn {
namespace {

bool IsPort(const std::string& word) {
  return !word.empty() && word.size() <= 5 &&
         std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::string YarpConfFile(const Environment& environment) {
  std::string folder = environment("YARP_CONFIG_HOME");
  if (folder.empty()) {
    const std::string config = environment("XDG_CONFIG_HOME");
    folder = (config.empty() ? environment("HOME") + "/.config" : config) + "/yarp";
  }
  std::string space = environment("YARP_NAMESPACE");
  std::replace(space.begin(), space.end(), '/', '_');
  if (!space.empty() && space.front() != '_') space.insert(0, 1, '_');
  return folder + "/" + (space.empty() || space == "_root" ? "yarp" : space) + ".conf";
}

std::string ServerInYarpConf(const std::string& text) {
  std::string host, port;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string first, second;
    words >> first >> second;
    if (first == "host") {
      host = second;
    } else if (first == "port") {
      port = second;
    } else if (host.empty() && !first.empty() && IsPort(second)) {
      host = first;
      port = second;
    }
  }
  if (host.empty() || !IsPort(port)) return {};
  return (host.find(':') == std::string::npos ? host : "[" + host + "]") + ":" + port;
}

}  // namespace coopdyn
