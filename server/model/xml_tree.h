// SPDX-License-Identifier: MIT
// XML nodes that remember file and line, so that a model composed from several files can still report them.
// One thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/diagnostics.h"

namespace coopdyn {

struct XmlNode {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::string text;  // between its tags, trimmed
  std::vector<XmlNode> children;
  SourceLine where;

  /// Empty if missing.
  std::string Attribute(std::string_view key) const;
  bool Has(std::string_view key) const;
  void Set(const std::string& key, std::string value);
  void Remove(std::string_view key);
  /// The first child named `child`; null if none.
  const XmlNode* Child(std::string_view child) const;
  XmlNode* Child(std::string_view child);
  /// Text of the first child named `child`; empty if none.
  std::string TextOf(std::string_view child) const;
  /// Appends a child with this node's file and line.
  XmlNode& Add(std::string child, std::string content = {});
};

/// Parses a model's XML. Reports an error and returns nullopt if it is malformed or exceeds the limits of
/// sdf_parts.h.
std::optional<XmlNode> ParseXml(const std::string& text, const std::string& file, Diagnostics& diagnostics);

/// Prints `root` with each tag on its own line; `lines[n]` is the origin of line n + 1.
std::string PrintXml(const XmlNode& root, std::vector<SourceLine>& lines);

}  // namespace coopdyn
