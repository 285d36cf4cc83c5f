// SPDX-License-Identifier: MIT
// Parses an experiment's XML and reads the values of its elements. Treats invalid values as missing: the
// grammar (grammar.h) reports them. One thread.
#pragma once

#include <tinyxml2.h>

#include <optional>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"
#include "server/geometry/shape.h"

namespace coopdyn::rosiml {

using Element = tinyxml2::XMLElement;

/// Limits of an experiment's size.
inline constexpr std::size_t kMaxBytes = 4u << 20;
inline constexpr int kMaxElements = 50'000;

/// Parses `text` into `document`. Reports an error and returns null if `text` is not XML, has a DOCTYPE or is
/// too large.
Element* Parse(std::string_view text, const std::string& file, tinyxml2::XMLDocument& document,
               Diagnostics& diagnostics);

/// Parses all of `word` as a finite number; nullopt if it is not one.
std::optional<double> ParseNumber(std::string_view word);

/// The attribute's text; empty if missing.
std::string Text(const Element& element, const char* attribute);
double Number(const Element& element, const char* attribute, double otherwise);
std::optional<double> Number(const Element& element, const char* attribute);
bool Flag(const Element& element, const char* attribute, bool otherwise);
/// A colour RRGGBB as "r g b", each from 0 to 1; empty if invalid.
std::string Colour(const Element& element, const char* attribute);

/// The first child named `child` (null if none), and its attributes.
const Element* Child(const Element& element, const char* child);
double NumberIn(const Element& element, const char* child, const char* attribute, double otherwise);
std::string TextIn(const Element& element, const char* child, const char* attribute);

/// The pose in the element's attributes x y z and alpha beta gamma: R = Rz(gamma) Ry(beta) Rx(alpha), in
/// degrees unless type="rad".
Pose PoseOf(const Element& element);
/// The pose in the child <pose>; the identity without one.
Pose PoseIn(const Element& element);

/// Calls visit(child) for each child element.
template <typename Visit>
void ForEachChild(const Element& element, Visit visit) {
  for (const Element* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    visit(*child);
  }
}

}  // namespace coopdyn::rosiml
