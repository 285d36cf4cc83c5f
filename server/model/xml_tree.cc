// SPDX-License-Identifier: MIT
#include "server/model/xml_tree.h"

#include <tinyxml2.h>

#include <algorithm>

#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

XmlNode ToNode(const tinyxml2::XMLElement& element, const std::string& file) {
  XmlNode node;
  node.name = element.Name();
  node.where = {file, element.GetLineNum()};
  for (const tinyxml2::XMLAttribute* one = element.FirstAttribute(); one != nullptr; one = one->Next()) {
    node.attributes.emplace_back(one->Name(), one->Value());
  }
  if (element.GetText() != nullptr) node.text = std::string(Trim(element.GetText()));
  for (const tinyxml2::XMLElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    node.children.push_back(ToNode(*child, file));
  }
  return node;
}

std::string Escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\n':
        out += ' ';
        break;
      default:
        out += c;
    }
  }
  return out;
}

void Print(const XmlNode& node, std::string& out, std::vector<SourceLine>& lines) {
  lines.push_back(node.where);
  out += "<" + node.name;
  for (const auto& [key, value] : node.attributes) out += " " + key + "=\"" + Escaped(value) + "\"";
  if (node.text.empty() && node.children.empty()) {
    out += "/>\n";
    return;
  }
  out += ">" + Escaped(node.text);
  if (!node.children.empty()) {
    out += "\n";
    for (const XmlNode& child : node.children) Print(child, out, lines);
    lines.push_back(node.where);
  }
  out += "</" + node.name + ">\n";
}

/// `text` with each `<?xml … ?>` blanked, so that lines keep their numbers.
std::string WithoutDeclaration(std::string text) {
  for (std::size_t start = text.find("<?xml"); start != std::string::npos;
       start = text.find("<?xml", start)) {
    const std::size_t end = text.find("?>", start);
    if (end == std::string::npos) break;
    std::replace_if(
        text.begin() + static_cast<std::ptrdiff_t>(start),
        text.begin() + static_cast<std::ptrdiff_t>(end + 2), [](char c) { return c != '\n'; }, ' ');
  }
  return text;
}

}  // namespace

std::string XmlNode::Attribute(std::string_view key) const {
  const auto found = std::ranges::find(attributes, key, &std::pair<std::string, std::string>::first);
  return found == attributes.end() ? std::string() : found->second;
}

bool XmlNode::Has(std::string_view key) const {
  return std::ranges::find(attributes, key, &std::pair<std::string, std::string>::first) != attributes.end();
}

void XmlNode::Set(const std::string& key, std::string value) {
  Remove(key);
  attributes.emplace_back(key, std::move(value));
}

void XmlNode::Remove(std::string_view key) {
  std::erase_if(attributes, [key](const auto& one) { return one.first == key; });
}

const XmlNode* XmlNode::Child(std::string_view child) const {
  const auto found = std::ranges::find(children, child, &XmlNode::name);
  return found == children.end() ? nullptr : &*found;
}

XmlNode* XmlNode::Child(std::string_view child) {
  const auto found = std::ranges::find(children, child, &XmlNode::name);
  return found == children.end() ? nullptr : &*found;
}

std::string XmlNode::TextOf(std::string_view child) const {
  const XmlNode* found = Child(child);
  return found == nullptr ? std::string() : found->text;
}

XmlNode& XmlNode::Add(std::string child, std::string content) {
  XmlNode node;
  node.name = std::move(child);
  node.text = std::move(content);
  node.where = where;
  return children.emplace_back(std::move(node));
}

std::optional<XmlNode> ParseXml(const std::string& text, const std::string& file, Diagnostics& diagnostics) {
  if (!IsModelSize(text, file, diagnostics)) return std::nullopt;
  tinyxml2::XMLDocument document;
  document.Parse(text.c_str(), text.size());
  if (document.ErrorID() == tinyxml2::XML_ERROR_PARSING_DECLARATION) {
    // Older programs accept a declaration after a comment.
    const std::string without = WithoutDeclaration(text);
    document.Parse(without.c_str(), without.size());
  }
  if (document.Error()) {
    diagnostics.Error({file, document.ErrorLineNum()},
                      std::string("not well-formed XML (") + document.ErrorName() + ")");
    return std::nullopt;
  }
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr) {
    diagnostics.Error({file, 0},
                      "a robot model starts with <sdf version=\"1.9\"> or <robot name=\"…\"> (URDF)");
    return std::nullopt;
  }
  if (!IsModelCount(*root, file, diagnostics)) return std::nullopt;
  return ToNode(*root, file);
}

std::string PrintXml(const XmlNode& root, std::vector<SourceLine>& lines) {
  std::string out;
  Print(root, out, lines);
  return out;
}

}  // namespace coopdyn
