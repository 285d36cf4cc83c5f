// SPDX-License-Identifier: MIT
#include "server/rosiml/xml.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "server/base/words.h"
#include "server/rosiml/xml_mistakes.h"

namespace coopdyn::rosiml {

namespace {

/// The line of a DOCTYPE before the root element; 0 if none. Without a DOCTYPE there are no custom entities.
int DoctypeLine(std::string_view text) {
  std::size_t at = 0;
  while ((at = text.find('<', at)) != std::string_view::npos) {
    const std::string_view rest = text.substr(at);
    const bool comment = rest.starts_with("<!--");
    if (!comment && rest.starts_with("<!"))
      return 1 + static_cast<int>(std::ranges::count(text.substr(0, at), '\n'));
    if (!comment && !rest.starts_with("<?")) return 0;
    const std::size_t end = comment ? rest.find("-->", 4) : rest.find("?>");
    if (end == std::string_view::npos) return 0;
    at += end;
  }
  return 0;
}

/// True if the document has more elements than allowed.
bool IsTooMany(const Element& root) {
  int count = 0;
  const tinyxml2::XMLNode* node = &root;
  while (node != nullptr && count <= kMaxElements) {
    ++count;
    if (node->FirstChildElement() != nullptr) {
      node = node->FirstChildElement();
      continue;
    }
    while (node != nullptr && node != &root && node->NextSiblingElement() == nullptr) node = node->Parent();
    node = node == nullptr || node == &root ? nullptr : node->NextSiblingElement();
  }
  return count > kMaxElements;
}

}  // namespace

Element* Parse(std::string_view text, const std::string& file, tinyxml2::XMLDocument& document,
               Diagnostics& diagnostics) {
  if (text.size() > kMaxBytes) {
    diagnostics.Error({file, 0}, "an experiment has at most 4 MiB, this text has more");
    return nullptr;
  }
  if (const int line = DoctypeLine(text); line > 0) {
    diagnostics.Error(
        {file, line},
        "a DOCTYPE and entities are not read: remove it, and write out what entities stand for");
    return nullptr;
  }
  const int before = diagnostics.errors();
  FindXmlMistakes(text, file, diagnostics);
  if (diagnostics.errors() > before) return nullptr;
  const bool is_parsed = document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS;
  Element* const root = is_parsed ? document.RootElement() : nullptr;
  if (root == nullptr) {
    diagnostics.Error({file, document.ErrorLineNum()}, "this is not well-formed XML");
    return nullptr;
  }
  if (IsTooMany(*root)) {
    diagnostics.Error({file, root->GetLineNum()},
                      "an experiment has at most " + std::to_string(kMaxElements) + " elements");
    return nullptr;
  }
  return root;
}

std::optional<double> ParseNumber(std::string_view word) {
  word = Trim(word);
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc() || word.empty() || end != word.data() + word.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::string Text(const Element& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  return text == nullptr ? std::string() : std::string(Trim(text));
}

std::optional<double> Number(const Element& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  constexpr double kMost = 1e9;  // the grammar reports larger numbers
  const std::optional<double> value = text == nullptr ? std::nullopt : ParseNumber(text);
  return value && std::abs(*value) <= kMost ? value : std::nullopt;
}

double Number(const Element& element, const char* attribute, double otherwise) {
  return Number(element, attribute).value_or(otherwise);
}

bool Flag(const Element& element, const char* attribute, bool otherwise) {
  const std::string text = Text(element, attribute);
  return text.empty() ? otherwise : text == "true" || text == "1";
}

std::string Colour(const Element& element, const char* attribute) {
  const std::string text = Text(element, attribute);
  if (text.size() < 6 || text.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos) return {};
  std::string out;
  for (std::size_t i = 0; i < 6; i += 2) {
    int part = 0;
    std::from_chars(text.data() + i, text.data() + i + 2, part, 16);
    constexpr int kDigits = 4;
    char digits[20];
    const auto end =
        std::to_chars(digits, digits + sizeof digits, part / 255.0, std::chars_format::fixed, kDigits);
    out += (out.empty() ? "" : " ") + std::string(digits, end.ptr);
  }
  return out;
}

const Element* Child(const Element& element, const char* child) {
  return element.FirstChildElement(child);
}

double NumberIn(const Element& element, const char* child, const char* attribute, double otherwise) {
  const Element* found = Child(element, child);
  return found == nullptr ? otherwise : Number(*found, attribute, otherwise);
}

std::string TextIn(const Element& element, const char* child, const char* attribute) {
  const Element* found = Child(element, child);
  return found == nullptr ? std::string() : Text(*found, attribute);
}

Pose PoseOf(const Element& element) {
  const double to_rad = Text(element, "type") == "rad" ? 1 : std::numbers::pi / 180;
  return {Vector3(Number(element, "x", 0), Number(element, "y", 0), Number(element, "z", 0)),
          FromRollPitchYaw(to_rad * Number(element, "alpha", 0), to_rad * Number(element, "beta", 0),
                           to_rad * Number(element, "gamma", 0))};
}

Pose PoseIn(const Element& element) {
  const Element* pose = Child(element, "pose");
  return pose == nullptr ? Pose{} : PoseOf(*pose);
}

}  // namespace coopdyn::rosiml
