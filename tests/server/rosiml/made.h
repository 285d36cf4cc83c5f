// SPDX-License-Identifier: MIT
// Experiments in tests, and their translations.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "server/rosiml/translate.h"

namespace coopdyn::rosiml {

/// The translation of a text without errors.
inline Translation Made(const std::string& xml) {
  Diagnostics diagnostics;
  std::optional<Translation> made = Translate(xml, "x.xml", "x.", diagnostics);
  EXPECT_TRUE(made.has_value()) << diagnostics.ToString();
  return made.value_or(Translation{});
}

/// All messages about a text, including warnings.
inline std::string Said(const std::string& xml) {
  Diagnostics diagnostics;
  const bool is_made = Translate(xml, "x.xml", "x.", diagnostics).has_value();
  EXPECT_EQ(is_made, !diagnostics.has_errors());
  return diagnostics.ToString();
}

/// An experiment of the public grammar.
inline std::string Public(const std::string& environment, const std::string& robots = "",
                          const std::string& macros = "") {
  return "<rosiml version=\"0.8.41\"><simulator frequency=\"100\"/>" +
         (macros.empty() ? "" : "<macros>" + macros + "</macros>") + "<environment>" + environment +
         "</environment><robots>" + robots + "</robots></rosiml>";
}

/// A ball of the public grammar.
inline std::string Ball(const std::string& name, const std::string& pose = "<pose z=\"1\"/>",
                        const std::string& kg = "1") {
  return "<sphere name=\"" + name + "\"><dimension radius=\"0.1\"/>" + pose + "<physics><mass kg=\"" + kg +
         "\"/></physics></sphere>";
}

/// A robot of the public grammar.
inline std::string Robot(const std::string& body, const std::string& actuators = "",
                         const std::string& sensors = "", const std::string& pose = "") {
  return "<robot name=\"r\"><body>" + body + "</body>" + pose + "<actuators>" + actuators +
         "</actuators><sensors>" + sensors + "</sensors></robot>";
}

/// A hinge or slider from `source` to `destination` (none: the world); `more` may change its attributes.
inline std::string Motor(const std::string& attributes, const std::string& source,
                         const std::string& destination, const std::string& pose = "<pose/>",
                         const std::string& kind = "hinge") {
  return "<" + kind + " name=\"j\" " + attributes + "><source name=\"" + source + "\"/>" +
         (destination.empty() ? "" : "<destination name=\"" + destination + "\"/>") +
         "<force max=\"2\"/><velocity max=\"5\"/>" + pose + "</" + kind + ">";
}

/// An experiment as in the paper.
inline std::string Paper(const std::string& environment, const std::string& movables = "") {
  return "<rosiml version=\"1.0\"><environment>" + environment + "</environment><movables>" + movables +
         "</movables></rosiml>";
}

inline bool Has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

#define EXPECT_HAS(text, part) EXPECT_TRUE(::coopdyn::rosiml::Has((text), (part))) << (text)
#define EXPECT_HAS_NOT(text, part) EXPECT_FALSE(::coopdyn::rosiml::Has((text), (part))) << (text)

}  // namespace coopdyn::rosiml
