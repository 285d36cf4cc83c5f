// SPDX-License-Identifier: MIT
#include "checks.h"

#include <yarp/os/ContactStyle.h>
#include <yarp/os/Network.h>
#include <yarp/os/SystemClock.h>

#include <cmath>
#include <cstddef>
#include <cstdio>

namespace coopdyn {

bool Checks::That(const std::string& name, bool good, const std::string& got) {
  if (good) {
    ++passed_;
    std::printf("ok      %s\n", name.c_str());
  } else {
    ++failed_;
    std::printf("FAILED  %s: %s\n", name.c_str(), got.c_str());
  }
  std::fflush(stdout);
  return good;
}

bool Checks::Near(const std::string& name, double value, double expected, double within) {
  return That(name, std::abs(value - expected) <= within, Text(value) + ", not " + Text(expected));
}

bool Checks::AllNear(const std::string& name, std::span<const double> values,
                     std::span<const double> expected, double within) {
  bool good = values.size() == expected.size();
  for (std::size_t i = 0; good && i < values.size(); ++i) good = std::abs(values[i] - expected[i]) <= within;
  return That(name, good, Text(values) + ", not " + Text(expected));
}

void Checks::Note(const std::string& text) {
  std::printf("        %s\n", text.c_str());
  std::fflush(stdout);
}

int Checks::Finish() const {
  std::printf("%d passed, %d failed\n", passed_, failed_);
  return failed_ == 0 ? 0 : 1;
}

std::string Text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

std::string Text(std::span<const double> values) {
  std::string text = "(";
  for (const double value : values) text.append(text.size() > 1 ? " " : "").append(Text(value));
  return text.append(")");
}

bool WaitFor(const std::function<bool()>& holds, double within_s) {
  const double until = yarp::os::SystemClock::nowSystem() + within_s;
  while (!holds()) {
    if (yarp::os::SystemClock::nowSystem() > until) return false;
    Sleep(0.01);
  }
  return true;
}

void Sleep(double wall_s) {
  yarp::os::SystemClock::delaySystem(wall_s);
}

yarp::os::Bottle AskSimulation(const std::string& line) {
  yarp::os::ContactStyle style;
  style.carrier = "text_ack";
  style.quiet = true;
  style.timeout = 10;
  yarp::os::Bottle request(line), reply;
  yarp::os::Network::write(yarp::os::Contact("/simulation"), request, reply, style);
  return reply;
}

double SimulatedTime() {
  const yarp::os::Bottle reply = AskSimulation("get_clock");
  return reply.size() < 3 ? NAN : reply.get(1).asInt32() + reply.get(2).asInt32() * 1e-9;
}

}  // namespace coopdyn
