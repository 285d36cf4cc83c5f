// SPDX-License-Identifier: MIT
#include "server/rosiml/write_channel.h"

#include "server/rosiml/names.h"

namespace coopdyn::rosiml {

namespace {

std::string Attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + value + "\"";
}

/// `name` as clients read it: an experiment's names may contain characters that are invalid in XML.
std::string PlainName(const std::string& name) {
  constexpr std::size_t kMost = 100;
  return Simple(name, kMost);
}

std::string WordsOf(const Mapped& mapped) {
  const auto range = [](const char* name, const std::optional<std::pair<double, double>>& of) {
    return of ? Attribute(name, Exact(of->first) + " " + Exact(of->second)) : std::string();
  };
  std::string text = range("internal", mapped.internal);
  if (mapped.internal) text += range("external", mapped.external);
  if (mapped.noise.empty()) return text;
  return text + Attribute("noise", mapped.noise) + Attribute("noise_mean", Exact(mapped.noise_mean)) +
         Attribute("noise_sigma", Exact(mapped.noise_sigma));
}

std::string FilterOf(const Mapped& mapped) {
  if (mapped.filter.empty()) return "";
  return Attribute("filter", mapped.filter) +
         (mapped.filter == "low_pass" ? Attribute("filter_time_s", Exact(mapped.filter_time_s))
                                      : Attribute("filter_steps", std::to_string(mapped.filter_steps)));
}

}  // namespace

MadeText WriteChannel(const Movable& movable, const ChannelPlaces& places) {
  MadeText inside, out;
  for (const MotorValue& motor : movable.motors) {
    std::string joint = motor.thruster >= 0 ? places.thruster(motor.thruster)
                        : motor.muscle >= 0 ? places.muscle(motor.muscle)
                                            : places.joint(motor.joint);
    if (joint.empty()) continue;
    if (!motor.axis.empty()) joint += "." + motor.axis;
    inside.Add(motor.line, "<coopdyn:motor" + Attribute("name", PlainName(motor.name)) +
                               Attribute("joint", joint) + Attribute("mode", motor.mode) +
                               WordsOf(motor.mapped) + "/>");
  }
  for (const SensorValue& value : movable.values) {
    const std::string end = WordsOf(value.mapped) + FilterOf(value.mapped) +
                            (value.auxiliary ? Attribute("auxiliary", "true") : std::string()) + "/>";
    const std::string begin = "<coopdyn:value" + Attribute("name", PlainName(value.name));
    std::string where;
    if (value.sensor >= 0) {
      where = places.reading(value.sensor);
      if (!where.empty()) inside.Add(value.line, begin + where + end);
      continue;
    }
    if (value.joint >= 0 || value.muscle >= 0) {
      std::string joint = value.joint < 0 ? places.muscle(value.muscle) : places.joint(value.joint);
      if (joint.empty()) continue;
      if (!value.axis.empty()) joint += "." + value.axis;
      where = Attribute("joint", joint);
    } else if (value.body >= 0) {
      where = places.place(value.body, value.X_WN);
      if (where.empty()) continue;
      if (value.in_body) where += Attribute("frame", "body");
    }
    for (const std::string& of : value.of) inside.Add(value.line, begin + where + Attribute("of", of) + end);
  }
  if (inside.lines.empty()) return out;
  std::string aborts;
  for (const int sensor : movable.aborts) {
    const std::string module = places.module(sensor);
    if (!module.empty()) aborts += (aborts.empty() ? "" : " ") + module;
  }
  const int line = inside.lines.front();
  out.Add(line, "<coopdyn:channel" + Attribute("steps", std::to_string(movable.exchange_steps)) +
                    (movable.port == 0 ? "" : Attribute("port", std::to_string(movable.port))) +
                    (aborts.empty() ? "" : Attribute("abort", aborts)) + ">");
  out.text += inside.text;
  out.lines.insert(out.lines.end(), inside.lines.begin(), inside.lines.end());
  out.Add(line, "</coopdyn:channel>");
  out.Add(line, "<coopdyn:module type=\"channel\" name=\"channel\"/>");
  return out;
}

}  // namespace coopdyn::rosiml
