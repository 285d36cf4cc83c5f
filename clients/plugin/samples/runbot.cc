// SPDX-License-Identifier: MIT
// Walks a biped that a boom keeps upright, only by reflexes, like RunBot (Geng, Porr and Woergoetter 2006):
// the feet alone set the rhythm. A foot that touches down stretches its own leg and moves it back, and lifts
// the other leg and moves it ahead; a leg that is far enough ahead is stretched. Joints: left_hip, left_knee,
// right_hip, right_knee (positive: ahead; bent); contact sensors left_foot and right_foot. Logs the number of
// steps.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "cpp_controller.h"

namespace {

struct Leg {
  size_t hip = 0, knee = 0;  // channels
  size_t foot = 0;           // sensor
};

class Runbot {
 public:
  struct State {
    uint32_t stands;     // 0: the left leg carries, 1: the right leg
    uint32_t stretches;  // 1: the leg in the air is coming down
    double steps;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"ahead", "hip of the leg in the air, rad", 0.45, 0, 1.5},
        {"back", "hip of the leg that carries, rad", 0.4, 0, 1.5},
        {"bend", "knee of the leg in the air, rad", 0.9, 0, 2},
        {"stretch", "hip from which on the knee is stretched, rad", 0.3, -1, 1.5},
        {"stand", "knee of the leg that carries, rad", 0.1, 0, 1},
        {"gain", "of each motor, N m/rad", 8, 0, 1000},
        {"damping", "of each motor, N m s/rad", 0.2, 0, 100},
    };
    static const coopdyn_description description = {"walks a biped by reflexes",
                                                    COOPDYN_CHANNELS | COOPDYN_SENSORS | COOPDYN_SETPOINTS,
                                                    sizeof(State),
                                                    7,
                                                    options,
                                                    "contact"};
    return &description;
  }

  Runbot(const coopdyn_robot& robot, const double* options)
      : robot_(robot),
        ahead_rad_(options[0]),
        back_rad_(options[1]),
        bend_rad_(options[2]),
        stretch_rad_(options[3]),
        stand_rad_(options[4]),
        gain_nm_rad_(options[5]),
        damping_nms_rad_(options[6]) {
    for (size_t side = 0; side < 2; ++side) {
      const std::string name = side == 0 ? "left_" : "right_";
      legs_[side] = {Find(name + "hip"), Find(name + "knee"), FindFoot(name + "foot")};
    }
  }

  void Reset(uint64_t seed) {
    state = {};
    state.stands = coopdyn::Random(seed, robot_.id, 0) < 0.5 ? 0 : 1;
  }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    const Leg& carrying = legs_[state.stands];
    const Leg& swinging = legs_[1 - state.stands];
    if (readings.channels[swinging.hip].position > stretch_rad_) state.stretches = 1;
    if (state.stretches != 0 && readings.sensors[swinging.foot].values[0] > 0) {
      state.stands = 1 - state.stands;
      state.stretches = 0;
      state.steps += 1;
      return Move(readings, swinging, carrying, command);
    }
    Move(readings, carrying, swinging, command);
  }

 private:
  void Move(const coopdyn_readings& readings, const Leg& carrying, const Leg& swinging,
            coopdyn_command& command) const {
    Pull(readings, carrying.hip, -back_rad_, command);
    Pull(readings, carrying.knee, stand_rad_, command);
    Pull(readings, swinging.hip, ahead_rad_, command);
    Pull(readings, swinging.knee, state.stretches != 0 ? stand_rad_ : bend_rad_, command);
    coopdyn_log(&command, "steps", state.steps);
  }

  /// The motor neuron of a joint.
  void Pull(const coopdyn_readings& readings, size_t channel, double towards_rad,
            coopdyn_command& command) const {
    const coopdyn_channel& joint = readings.channels[channel];
    const double effort_nm =
        gain_nm_rad_ * (towards_rad - joint.position) - damping_nms_rad_ * joint.velocity;
    const double most_nm = robot_.channels[channel].max_effort;
    command.setpoints[channel] = {COOPDYN_EFFORT, std::clamp(effort_nm, -most_nm, most_nm)};
  }

  size_t Find(const std::string& joint) const {
    for (size_t i = 0; i < robot_.channel_count; ++i) {
      if (joint == robot_.channels[i].name && (robot_.channels[i].modes >> COOPDYN_EFFORT & 1) != 0) return i;
    }
    throw std::runtime_error("the robot has no driven joint " + joint);
  }
  size_t FindFoot(const std::string& name) const {
    for (size_t i = 0; i < robot_.sensor_count; ++i) {
      if (name == robot_.sensors[i].module) return i;
    }
    throw std::runtime_error("the robot has no contact sensor " + name);
  }

  const coopdyn_robot& robot_;
  const double ahead_rad_, back_rad_, bend_rad_, stretch_rad_, stand_rad_, gain_nm_rad_, damping_nms_rad_;
  Leg legs_[2];
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Runbot>();
}
