// SPDX-License-Identifier: MIT
#include "server/model/sdf_description.h"

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace coopdyn {

namespace {

using tinyxml2::XMLElement;

constexpr const char* kRoot =
    "<element name='sdf' required='1'><attribute name='version' type='string' default='" SDF_VERSION
    "' required='1'/></element>";

bool HasModelsAlone(const XMLElement& root) {
  bool is_model = root.Name() == std::string_view("sdf");
  for (const XMLElement* child = root.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement())
    is_model = is_model && child->Name() == std::string_view("model");
  return is_model;
}

void CollectNames(const XMLElement& element, std::set<std::string_view>& names) {
  names.insert(element.Name());
  for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement())
    CollectNames(*child, names);
}

/// Assembles libsdformat's own schema files: <element name required ref> with <attribute>s, <element>s and
/// <include filename required> for another file.
class DescriptionMaker {
 public:
  explicit DescriptionMaker(std::set<std::string_view> names) : names_(std::move(names)) {}

  /// A schema with the file `model.sdf` below its root.
  std::string Make() {
    out_.Parse(kRoot);
    Include("model.sdf", "0", *out_.RootElement());
    tinyxml2::XMLPrinter printer(nullptr, true);
    out_.Print(&printer);
    return printer.CStr();
  }

 private:
  void Include(const char* file, const char* required, XMLElement& into) {
    tinyxml2::XMLDocument document;
    document.Parse(sdf::SDF::EmbeddedSpec(file, true).c_str());
    const XMLElement* element = document.FirstChildElement("element");
    if (element != nullptr) Add(*element, required, into);
  }

  /// `required`: overrides the attribute of `element`; null: keep it.
  void Add(const XMLElement& element, const char* required, XMLElement& into) {
    if (required == nullptr) required = element.Attribute("required");
    // Only drop groups: a missing single value has a default that libsdformat may read.
    const bool is_group = element.FirstChildElement("element") != nullptr ||
                          element.FirstChildElement("include") != nullptr ||
                          element.Attribute("ref") != nullptr;
    const bool may_lack = required != nullptr && (*required == '0' || *required == '*' || *required == '-');
    const char* name = element.Attribute("name");
    if (is_group && may_lack && name != nullptr && !in_whole_ && !names_.contains(name)) return;
    XMLElement& copy = *into.InsertNewChildElement(element.Name());
    for (const auto* attribute = element.FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next())
      copy.SetAttribute(attribute->Name(), attribute->Value());
    if (required != nullptr) copy.SetAttribute("required", required);
    const auto each = [&element](const char* tag, const auto& act) {
      for (const auto* child = element.FirstChildElement(tag); child != nullptr;
           child = child->NextSiblingElement(tag))
        act(*child);
    };
    // Inside these, libsdformat also reads groups that do not occur in the file.
    constexpr std::array<std::string_view, 3> kWhole = {"sensor", "light", "particle_emitter"};
    const bool was_in_whole = in_whole_;
    in_whole_ = in_whole_ || (name != nullptr && std::ranges::count(kWhole, name) > 0);
    each("attribute", [&](const XMLElement& child) { copy.InsertEndChild(child.DeepClone(&out_)); });
    each("element", [&](const XMLElement& child) { Add(child, nullptr, copy); });
    each("include", [&](const XMLElement& child) {
      Include(child.Attribute("filename"), child.Attribute("required"), copy);
    });
    in_whole_ = was_in_whole;
  }

  const std::set<std::string_view> names_;
  bool in_whole_ = false;  // inside an element that is copied completely
  tinyxml2::XMLDocument out_;
};

}  // namespace

sdf::SDFPtr WholeDescription(const XMLElement& root) {
  const auto description = std::make_shared<sdf::SDF>();
  if (HasModelsAlone(root)) {
    tinyxml2::XMLDocument document;
    document.Parse(kRoot);
    XMLElement& include = *document.RootElement()->InsertNewChildElement("include");
    include.SetAttribute("filename", "model.sdf");
    include.SetAttribute("required", "0");
    tinyxml2::XMLPrinter printer(nullptr, true);
    document.Print(&printer);
    sdf::initString(printer.CStr(), description);
  } else {
    sdf::init(description);
  }
  return description;
}

sdf::SDFPtr DescriptionFor(const XMLElement& root) {
  const char* version = root.Attribute("version");
  // An older file is converted first, which introduces other names.
  if (!HasModelsAlone(root) || version == nullptr || version != std::string_view(SDF_VERSION))
    return WholeDescription(root);
  std::set<std::string_view> names;
  CollectNames(root, names);
  const auto description = std::make_shared<sdf::SDF>();
  sdf::initString(DescriptionMaker(std::move(names)).Make(), description);
  return description;
}

}  // namespace coopdyn
