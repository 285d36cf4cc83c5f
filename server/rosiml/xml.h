// SPDX-License-Identifier: MIT
// An experiment's XML, parsed, and the values of its elements. What is wrong with a value is said by the
// grammar (grammar.h); here it is left out. One thread.
#pragma once

#include <tinyxml2.h>

#include <optional>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"
#include "server/geometry/shape.h"

namespace coopdyn::rosiml {

using Element = tinyxml2::XMLElement;

/// An experiment has at most this many bytes and elements.
inline constexpr std::size_t kMaxBytes = 4u << 20;
inline constexpr int kMaxElements = 50'000;

/// Parses `text` into `document`. Null, and reported, if it is no XML, has a DOCTYPE or is too large.
Element* Parse(std::string_view text, const std::string& file, tinyxml2::XMLDocument& document,
               Diagnostics& diagnostics);

/// A finite number, the whole of `word`.
std::optional<double> ParseNumber(std::string_view word);

/// The attribute; empty without it.
std::string Text(const Element& element, const char* attribute);
double Number(const Element& element, const char* attribute, double otherwise);
std::optional<double> Number(const Element& element, const char* attribute);
bool Flag(const Element& element, const char* attribute, bool otherwise);
/// RRGGBB as "r g b", each from 0 to 1; empty if it is none.
std::string Colour(const Element& element, const char* attribute);

/// The first child called so, or null; and its attribute.
const Element* Child(const Element& element, const char* child);
double NumberIn(const Element& element, const char* child, const char* attribute, double otherwise);
std::string TextIn(const Element& element, const char* child, const char* attribute);

/// x y z and alpha beta gamma of the element itself: R = Rz(gamma) Ry(beta) Rx(alpha), degrees unless
/// type="rad".
Pose PoseOf(const Element& element);
/// The same of its child <pose>; the identity without one.
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
