// SPDX-License-Identifier: MIT
// The attributes of one XML element, each asked for by name; what nobody asked for is reported.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"

namespace tinyxml2 {
class XMLElement;
}

namespace coopdyn {

/// Reads one element. `element` and `diagnostics` outlive it. One thread.
class XmlAttributes {
 public:
  XmlAttributes(const tinyxml2::XMLElement& element, std::string file, Diagnostics& diagnostics);

  /// Its text; nothing if missing.
  std::optional<std::string> Text(const std::string& name);
  /// A finite number in [min, max]; nothing if missing or wrong (then reported).
  std::optional<double> Number(const std::string& name, double min, double max);
  std::optional<int> Integer(const std::string& name, int min, int max);
  /// true or false.
  std::optional<bool> Flag(const std::string& name);
  /// `count` finite numbers.
  std::optional<std::vector<double>> Numbers(const std::string& name, std::size_t count);

  void Error(const std::string& text);
  /// Reports that attribute `name` is needed, if it is missing.
  void Require(const std::string& name);
  /// Reports the attributes that were never asked for.
  void Finish();
  SourceLine where() const;

 private:
  const tinyxml2::XMLElement& element_;
  std::string file_;
  Diagnostics& diagnostics_;
  std::vector<std::string> known_;
};

}  // namespace coopdyn
