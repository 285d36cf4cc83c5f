// SPDX-License-Identifier: MIT
// Controllers written for YARS compile against this header unchanged and become controllers that coopdyn
// loads:
//
//   g++ -O2 -fPIC -shared -I clients/plugin/yars -I clients/plugin MyController.cpp -o MyController.so
//
// A source has a class derived from RobotController and a function `extern "C" RobotController* create()`.
// The order of calls is create(), init(), reset(), { update() }, close(); after a reset of the run a new
// controller is created. update() is called once per exchange of the robot's channel. docs/controllers.md
// lists unsupported features.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "controller.h"
#include "yars/defines/types.h"
#include "yars/rc/RobotControllerParameter.hpp"
#include "yars/types/NameDimensionDomain.hpp"

using namespace std;  // NOLINT: sources rely on it

namespace coopdyn_yars {
struct Adapter;
}

class RobotController {
 public:
  RobotController() = default;
  RobotController(const RobotController&) = delete;
  RobotController& operator=(const RobotController&) = delete;
  virtual ~RobotController() = default;

  virtual void init() = 0;
  virtual void update() = 0;
  virtual void reset() = 0;
  virtual void close() = 0;

  /// setQuit() ends the run after this step. A controller cannot reset the run: setReset() only prints a
  /// message.
  void setQuit() { quit_ = true; }
  void setReset() { reset_ = true; }
  bool isQuit() const { return quit_; }
  bool isReset() const { return reset_; }
  void unsetStatus() { quit_ = reset_ = false; }

  int getSeed() const { return seed; }
  /// Calls of update() per second.
  int frequency() const { return frequency_; }

  std::vector<double> getMotorValues() const { return motors; }
  void getMotorValues(std::vector<double>* values) const { *values = motors; }

  /// All values as lines of text, or as one text each.
  void getSensorConfiguration(std::string* text) const { *text = Lines(sensorConfiguration); }
  void getMotorConfiguration(std::string* text) const { *text = Lines(motorConfiguration); }
  void getSensorConfiguration(std::vector<std::string>* names) const { *names = Names(sensorConfiguration); }
  void getMotorConfiguration(std::vector<std::string>* names) const { *names = Names(motorConfiguration); }
  void printSensorMotorConfiguration() const {
    std::cout << "sensors:\n" << Lines(sensorConfiguration) << "motors:\n" << Lines(motorConfiguration);
    std::cout.flush();
  }

  /// Logs the number, or several as NAME_0, NAME_1, …, after every update(); at most COOPDYN_MAX_LOGS.
  void addLoggable(const std::string& name, double* value) { loggables_.push_back({name, value, nullptr}); }
  void addLoggable(const std::string& name, std::vector<double>* values) {
    loggables_.push_back({name, nullptr, values});
  }

  /// On-screen text, which is not displayed.
  void addLine(const std::string& line) { lines_.push_back(line); }
  void clearOsd() { lines_.clear(); }

 protected:
  std::vector<double> motors;   // external values
  std::vector<double> sensors;  // external values
  std::vector<NameDimensionDomain> motorConfiguration, sensorConfiguration;
  RobotControllerParameter parameter;
  int argc = 0;
  const char** argv = nullptr;
  int seed = -1;  // has no effect

 private:
  friend struct coopdyn_yars::Adapter;
  struct Loggable {
    std::string name;
    const double* value;
    const std::vector<double>* values;
  };

  static std::vector<std::string> Names(const std::vector<NameDimensionDomain>& all) {
    std::vector<std::string> names;
    for (const NameDimensionDomain& one : all) {
      for (int i = 0; i < one.dimension; ++i) names.push_back(one.name + " " + std::to_string(i));
    }
    return names;
  }
  static std::string Lines(const std::vector<NameDimensionDomain>& all) {
    std::ostringstream lines;
    int index = 0;
    for (const std::string& name : Names(all)) lines << index++ << " = " << name << '\n';
    return lines.str();
  }

  bool quit_ = false, reset_ = false, told_reset_ = false, told_logs_ = false;
  int frequency_ = 0;
  std::vector<Loggable> loggables_;
  std::vector<std::string> lines_;
};

/// Defined by the source.
extern "C" RobotController* create();

namespace coopdyn_yars {

/// Adapts a YARS controller to coopdyn.
struct Adapter {
  const coopdyn_robot* robot;
  RobotController* controller;

  static const coopdyn_description* Describe() {
    static const coopdyn_description description = {
        "a controller written for YARS", COOPDYN_MAPPED, 0, COOPDYN_ANY_OPTIONS, nullptr, nullptr};
    return &description;
  }

  static void* Create(const coopdyn_robot* robot, const double* /*options*/, char* error, std::size_t size) {
    RobotController* const controller = create();
    if (controller == nullptr) {
      coopdyn_copy(error, "its create() gives no controller", size);
      return nullptr;
    }
    Adapter* const adapter = new Adapter{robot, controller};
    for (std::size_t i = 0; i < robot->motor_count; ++i)
      Add(robot->motors[i], controller->motorConfiguration);
    controller->motors.resize(robot->motor_count);
    for (std::size_t i = 0; i < robot->mapped_count; ++i) {
      if (robot->mapped[i].auxiliary != 0) continue;
      Add(robot->mapped[i], controller->sensorConfiguration);
      controller->sensors.push_back(0);
    }
    for (std::size_t i = 0; i < robot->option_count; ++i)
      controller->parameter.add(robot->options[i].name, TextOf(robot->options[i].value));
    controller->frequency_ = static_cast<int>(1 / robot->exchange_s + 0.5);
    controller->init();
    return adapter;
  }

  static void Reset(void* instance, std::uint64_t run_seed) {
    std::srand(static_cast<unsigned>(run_seed));  // many sources call rand()
    static_cast<Adapter*>(instance)->controller->reset();
  }

  static void Step(void* instance, const coopdyn_readings* readings, coopdyn_command* command) {
    const Adapter& adapter = *static_cast<Adapter*>(instance);
    RobotController& controller = *adapter.controller;
    const coopdyn_robot& robot = *adapter.robot;
    std::size_t sensor = 0;
    for (std::size_t i = 0; i < robot.mapped_count && sensor < controller.sensors.size(); ++i) {
      if (robot.mapped[i].auxiliary == 0) controller.sensors[sensor++] = readings->mapped[i];
    }
    controller.update();
    for (std::size_t i = 0; i < robot.motor_count && i < controller.motors.size(); ++i)
      command->motors[i] = controller.motors[i];
    if (controller.quit_) command->end_run = 1;
    if (controller.reset_ && !controller.told_reset_) {
      controller.told_reset_ = true;
      std::cerr
          << "a controller of YARS asks for a reset, and cannot have one: coopdyn resets runs by clients\n";
    }
    controller.unsetStatus();
    Log(controller, command);
  }

  static void Destroy(void* instance) {
    const Adapter* const adapter = static_cast<Adapter*>(instance);
    adapter->controller->close();
    delete adapter->controller;
    delete adapter;
  }

 private:
  /// Merges neighbours of the same name.
  static void Add(const coopdyn_mapped& one, std::vector<NameDimensionDomain>& all) {
    if (all.empty() || all.back().name != one.name) all.emplace_back(one.name);
    NameDimensionDomain& last = all.back();
    ++last.dimension;
    last.internal.emplace_back(one.internal_min, one.internal_max);
    last.external.emplace_back(one.external_min, one.external_max);
    last.names.emplace_back(one.name);
  }

  /// The shortest text that parses to the same number.
  static std::string TextOf(double value) {
    constexpr int kAllDigits = 17;
    std::string text;
    for (int digits = 6; digits <= kAllDigits; ++digits) {
      std::ostringstream out;
      out.precision(digits);
      out << value;
      text = out.str();
      if (std::strtod(text.c_str(), nullptr) == value) break;
    }
    return text;
  }

  static void Log(RobotController& controller, coopdyn_command* command) {
    for (const RobotController::Loggable& one : controller.loggables_) {
      if (one.value != nullptr) LogOne(controller, command, one.name, *one.value);
      for (std::size_t i = 0; one.values != nullptr && i < one.values->size(); ++i)
        LogOne(controller, command, one.name + "_" + std::to_string(i), (*one.values)[i]);
    }
  }
  /// Replaces other characters in the name: names of logs have letters, digits and _.
  static void LogOne(RobotController& controller, coopdyn_command* command, std::string name, double value) {
    if (command->log_count == COOPDYN_MAX_LOGS) {
      if (!controller.told_logs_) std::cerr << "'" << name << "' is not logged: there are too many numbers\n";
      controller.told_logs_ = true;
      return;
    }
    const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    for (char& c : name) {
      if (!is_letter(c) && !(c >= '0' && c <= '9')) c = '_';
    }
    if (name.empty() || !is_letter(name.front())) name = "log_" + name;
    coopdyn_log(command, name.c_str(), value);
  }
};

}  // namespace coopdyn_yars

/// Weak, because several files of one library may include this header.
extern "C" __attribute__((weak, visibility("default"))) const coopdyn_controller* coopdyn_controller_entry() {
  using coopdyn_yars::Adapter;
  static const coopdyn_controller functions = {COOPDYN_CONTROLLER_VERSION,
                                               Adapter::Describe,
                                               Adapter::Create,
                                               Adapter::Reset,
                                               Adapter::Step,
                                               nullptr,
                                               nullptr,
                                               Adapter::Destroy};
  return &functions;
}
