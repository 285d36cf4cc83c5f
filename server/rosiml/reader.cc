// SPDX-License-Identifier: MIT
#include "server/rosiml/reader.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/rosiml/lines.h"
#include "server/rosiml/names.h"

namespace coopdyn::rosiml {

Shape Reader::ShapeOf(std::string_view kind, const Element& lengths) {
  // Missing and invalid lengths have been reported; the model's reader reports ones that are too small.
  constexpr double kLeast_m = 1e-9, kMost_m = 1e3;
  const auto length = [&](const char* name) {
    return std::clamp(Number(lengths, name, 1), kLeast_m, kMost_m);
  };
  if (kind == "box") return Box{Vector3(length("width"), length("depth"), length("height"))};
  if (kind == "cylinder") return Cylinder{length("radius"), length("height")};
  if (kind == "capsule") return Capsule{length("radius"), length("height")};
  return Sphere{length("radius")};
}

Quaternion Reader::LookAlong(const Vector3& direction) {
  const Vector3 x = direction.normalized();
  const bool steep = std::abs(x.z()) > 1 - 1e-9;
  const Vector3 y = steep ? Vector3(Vector3::UnitY()) : Vector3(Vector3::UnitZ().cross(x).normalized());
  Matrix3 axes;
  axes << x, y, x.cross(y);
  return Quaternion(axes).normalized();
}

bool Reader::Add(Movable& movable, Body body, const Element& at) {
  constexpr int kMost = 10'000;
  const int before = bodies_;
  bodies_ += 1 + static_cast<int>(body.parts.size());
  if (bodies_ <= kMost) {
    movable.bodies.push_back(std::move(body));
    return true;
  }
  if (before <= kMost)
    Error(at, "an experiment has at most " + std::to_string(kMost) +
                  " bodies and parts of them, with macros written out");
  return false;
}

void Reader::AddName(Movable& movable, const std::string& name, const Pose& X_WN, const Element& at) {
  const auto same = std::ranges::find(movable.names, name, &Named::name);
  if (same != movable.names.end() && !name.empty()) {
    Error(at, "there are two objects '" + Printable(name) + "' in '" + Printable(movable.name) +
                  "' (the first in line " + std::to_string(same->line) + "): give one another name");
    return;
  }
  movable.names.push_back({name, static_cast<int>(movable.bodies.size()) - 1, X_WN, at.GetLineNum()});
}

const Named* Reader::Find(const Movable& movable, const std::string& name, const Element& at) {
  if (name.empty()) return nullptr;  // reported before
  const auto found = std::ranges::find(movable.names, name, &Named::name);
  if (found != movable.names.end()) return &*found;
  Error(at, "there is no object '" + Printable(name) + "' in '" + Printable(movable.name) + "'" +
                MeantOf(name, movable.names, &Named::name, diagnostics_));
  return nullptr;
}

bool Reader::IsNew(std::map<std::string, int>& lines, const Element& element, const std::string& name) {
  const auto [first, is_new] = lines.emplace(name, element.GetLineNum());
  if (is_new || name.empty()) return true;
  Error(element, "the name '" + Printable(name) + "' stands in line " + std::to_string(first->second) +
                     ", too: give one another name");
  return false;
}

bool Reader::IsSound(const Element& element) const {
  const tinyxml2::XMLNode* last = &element;
  while (last->LastChild() != nullptr) last = last->LastChild();
  return std::ranges::none_of(diagnostics_.all(), [&](const Diagnostic& one) {
    return one.level == Diagnostic::Level::kError && one.where.line >= element.GetLineNum() &&
           one.where.line <= last->GetLineNum();
  });
}

void Reader::AddJoint(Movable& movable, Joint joint, const Element& at) {
  if (joint.source == joint.destination) {
    Error(at, "the joint '" + Printable(joint.name) + "' joins a body with itself");
    return;
  }
  movable.joints.push_back(std::move(joint));
}

Mapped Reader::MappedOf(const Element& element, std::optional<std::pair<double, double>> internal,
                        double domain_unit) {
  Mapped mapped{.internal = internal};
  const auto range = [this](const Element& of) {
    std::pair<double, double> ends{Number(of, "min", 0), Number(of, "max", 0)};
    if (ends.first == ends.second) Error(of, "'min' and 'max' must differ");
    return ends;
  };
  if (const Element* domain = Child(element, "domain")) {
    mapped.internal = range(*domain);
    mapped.internal->first *= domain_unit;
    mapped.internal->second *= domain_unit;
  }
  if (mapped.internal && !(mapped.internal->first < mapped.internal->second)) mapped.internal.reset();
  if (const Element* mapping = Child(element, "mapping")) {
    mapped.external = range(*mapping);
    if (!mapped.internal)
      Warn(*mapping, "<mapping> needs the range of the values: write <domain min=\"…\" max=\"…\"/>");
  }
  if (const Element* filter = Child(element, "filter")) ReadFilter(*filter, mapped);
  const Element* noise = Child(element, "noise");
  if (noise == nullptr) return mapped;
  const std::string module = Text(*noise, "module") + Text(*noise, "kind");
  mapped.noise = module == "gauss" ? "gaussian" : "uniform";
  mapped.noise_sigma = Number(*noise, "sigma", 1);
  mapped.noise_mean = Number(*noise, "mean", 0);
  ForEachChild(*noise, [&](const Element& parameter) {
    const double value = ParseNumber(Text(parameter, "value")).value_or(0);
    if (Text(parameter, "name") == "sigma") mapped.noise_sigma = value;
    if (Text(parameter, "name") == "mean") mapped.noise_mean = value;
  });
  if (mapped.noise_sigma < 0) Error(*noise, "'sigma' must not lie below 0");
  mapped.noise_sigma = std::abs(mapped.noise_sigma);
  return mapped;
}

void Reader::ReadFilter(const Element& filter, Mapped& mapped) {
  const std::string word = Text(filter, "module") + Text(filter, "kind");
  const std::string kind = word == "lowPass" ? "low_pass" : word;
  if (kind != "mean" && kind != "median" && kind != "low_pass") {
    if (filter.Attribute("module") == nullptr) return;  // reported by the grammar
    return Warn(filter,
                "there is no filter '" + Printable(word) +
                    "' here: it is left out; there are mean and median (steps) and low_pass (time, s)");
  }
  std::optional<double> steps = Number(filter, "steps"), time_s = Number(filter, "time");
  ForEachChild(filter, [&](const Element& parameter) {
    if (Text(parameter, "name") == "steps") steps = ParseNumber(Text(parameter, "value"));
    if (Text(parameter, "name") == "time") time_s = ParseNumber(Text(parameter, "value"));
  });
  constexpr double kMostSteps = 100, kLeast_s = 1e-6, kMost_s = 1e4;
  const bool is_low_pass = kind == "low_pass";
  if (is_low_pass && !(time_s && *time_s >= kLeast_s && *time_s <= kMost_s))
    return Error(filter,
                 "the filter " + word + " needs its time constant 'time', a number of seconds above 0");
  if (!is_low_pass && !(steps && *steps >= 1 && *steps <= kMostSteps && *steps == std::floor(*steps)))
    return Error(filter, "the filter " + word + " needs 'steps', how many values count: 1 to 100");
  mapped.filter = kind;
  mapped.filter_steps = static_cast<int>(steps.value_or(1));
  mapped.filter_time_s = time_s.value_or(0);
}

int Reader::StepsOf(const Element& at, double frequency_hz, double controller_hz) {
  if (frequency_hz <= 0 || controller_hz <= 0) return 1;  // reported before
  const double steps = std::round(frequency_hz / controller_hz);
  constexpr double kMost = 1e6;
  if (steps >= 1 && steps <= kMost && std::abs(steps * controller_hz / frequency_hz - 1) < 1e-9)
    return static_cast<int>(steps);
  Error(at, "the controller's frequency must divide that of the simulator, " + Exact(frequency_hz) +
                " Hz, not be " + Exact(controller_hz) + " Hz");
  return 1;
}

std::optional<Setting> Reader::StepOf(const Element& simulator, double frequency_hz) {
  constexpr double kMicro = 1e6, kLeast_us = 500, kMost_us = 100'000;
  const double step_us = std::round(kMicro / frequency_hz);
  if (!(step_us >= kLeast_us && step_us <= kMost_us)) return std::nullopt;  // reported before
  if (std::abs(step_us * frequency_hz / kMicro - 1) > 1e-9)
    Warn(simulator, "a step has whole microseconds: it is " + Exact(step_us) + " µs");
  return Setting{"step " + Exact(step_us / 1000) + "ms", simulator.GetLineNum()};
}

}  // namespace coopdyn::rosiml
