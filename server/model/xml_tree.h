// SPDX-License-Identifier: MIT
// XML as values that remember where they were written, so that a model put together from several files can
// still say file and line. One thread.
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
  /// The first child called so; null if there is none.
  const XmlNode* Child(std::string_view child) const;
  XmlNode* Child(std::string_view child);
  /// Text of the first child called so; empty if there is none.
  std::string TextOf(std::string_view child) const;
  /// Appends a child that was written where this one was.
  XmlNode& Add(std::string child, std::string content = {});
};

/// What a model may have before it is read (sdf_parts.h). Nothing, and reported, for anything else.
std::optional<XmlNode> ParseXml(const std::string& text, const std::string& file, Diagnostics& diagnostics);

/// Every tag starts a line of its own; `lines[n]` is where line n + 1 was written.
std::string PrintXml(const XmlNode& root, std::vector<SourceLine>& lines);

}  // namespace coopdyn
