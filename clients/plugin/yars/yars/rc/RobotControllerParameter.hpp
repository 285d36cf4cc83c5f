// SPDX-License-Identifier: MIT
// For sources written for YARS: the parameters of a controller, set as options in the scenario's line. Option
// names have lower-case letters, digits and _, and values are numbers: "phase shift" is phase_shift, true is
// 1.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <map>
#include <string>
#include <vector>

class RobotControllerParameter : public std::map<std::string, std::string> {
 public:
  bool exists(const std::string& name) const { return count(Plain(name)) != 0; }
  void add(const std::string& name, const std::string& value) { emplace(Plain(name), value); }
  void get(const std::string& name, std::string* value) const {
    const const_iterator found = find(Plain(name));
    *value = found == end() ? std::string() : found->second;
  }

  std::string stringValue(const std::string& name) const {
    std::string value;
    get(name, &value);
    return value;
  }
  double doubleValue(const std::string& name) const {
    return std::strtod(stringValue(name).c_str(), nullptr);
  }
  float floatValue(const std::string& name) const { return static_cast<float>(doubleValue(name)); }
  int intValue(const std::string& name) const { return static_cast<int>(doubleValue(name)); }
  bool boolValue(const std::string& name) const {
    return stringValue(name) == "true" || doubleValue(name) != 0;
  }
  std::vector<double> doubleList(const std::string& name) const {
    std::vector<double> values;
    const std::string text = stringValue(name);
    for (std::size_t at = 0; (at = text.find_first_not_of(" ,", at)) != std::string::npos;
         at = text.find_first_of(" ,", at)) {
      values.push_back(std::strtod(text.c_str() + at, nullptr));
    }
    return values;
  }
  std::vector<int> intList(const std::string& name) const {
    std::vector<int> values;
    for (const double value : doubleList(name)) values.push_back(static_cast<int>(value));
    return values;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& one : *this) all.push_back(one.first);
    return all;
  }

  void set(const std::string& name, double& value, double otherwise) const {
    value = exists(name) ? doubleValue(name) : otherwise;
  }
  void set(const std::string& name, float& value, float otherwise) const {
    value = exists(name) ? floatValue(name) : otherwise;
  }
  void set(const std::string& name, int& value, int otherwise) const {
    value = exists(name) ? intValue(name) : otherwise;
  }
  void set(const std::string& name, bool& value, bool otherwise) const {
    value = exists(name) ? boolValue(name) : otherwise;
  }
  void set(const std::string& name, std::string& value, const std::string& otherwise) const {
    value = exists(name) ? stringValue(name) : otherwise;
  }

 private:
  /// The option name for a parameter.
  static std::string Plain(std::string name) {
    for (char& c : name) {
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
      if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))) c = '_';
    }
    return name;
  }
};

inline std::ostream& operator<<(std::ostream& out, const RobotControllerParameter& parameter) {
  for (const auto& one : parameter) out << one.first << " = " << one.second << '\n';
  return out;
}
