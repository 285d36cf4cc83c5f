// SPDX-License-Identifier: MIT
// Broadcasts its readings for a test. Option `what`: 0 pose, 1 distances, 2 targets, 3 neighbours, 4
// messages, 5 the robot, 6 time and seed, 7 compass, 8 channels, 9 their descriptions, 10 motion.
#include <cmath>
#include <cstring>
#include <string_view>

#include "clients/plugin/cpp_controller.h"

namespace {

class Mirror {
 public:
  struct State {
    char nothing;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {{"what", "to show", 0, 0, 10}};
    static const coopdyn_description description = {"shows what it feels",
                                                    COOPDYN_DISTANCES | COOPDYN_POSE | COOPDYN_CHANNELS |
                                                        COOPDYN_TARGETS | COOPDYN_NEIGHBOURS |
                                                        COOPDYN_MESSAGES | COOPDYN_COMPASS | COOPDYN_MOTION,
                                                    sizeof(State), 1, options};
    return &description;
  }

  Mirror(const coopdyn_robot& robot, const double* options)
      : robot_(robot), what_(static_cast<int>(options[0])) {}
  void Reset(uint64_t /*seed*/) {}

  void Step(const coopdyn_readings& r, coopdyn_command& command) {
    command.forward_m_s = 0.05;
    command.turn_rad_s = 0.3;
    const auto show = [&command](double value) { command.message[command.message_count++] = value; };
    switch (what_) {
      case 0:
        for (const double value : {r.x_m, r.y_m, r.heading_rad, r.forward_m_s, r.turn_rad_s}) show(value);
        break;
      case 1:
        for (size_t i = 0; i < r.distance_count && i < 8; ++i) show(std::fmin(r.distance_m[i], 99));
        break;
      case 2:
        show(static_cast<double>(r.target_count));
        if (r.target_count == 0) break;
        for (const double value : {static_cast<double>(r.targets[0].id), r.targets[0].distance_m,
                                   r.targets[0].bearing_rad, r.targets[0].red, r.targets[0].blue}) {
          show(value);
        }
        break;
      case 3:
        show(static_cast<double>(r.neighbour_count));
        for (size_t i = 0; i < r.neighbour_count && i < 2; ++i) {
          show(r.neighbours[i].id);
          show(r.neighbours[i].distance_m);
          show(r.neighbours[i].bearing_rad);
        }
        break;
      case 4:
        show(static_cast<double>(r.heard_count));
        if (r.heard_count == 0) break;
        show(r.heard[0].from.id);
        show(r.heard[0].from.distance_m);
        show(r.heard[0].count);
        show(r.heard[0].count > 0 ? r.heard[0].values[0] : 0);
        break;
      case 5:
        for (const double value :
             {static_cast<double>(robot_.id), static_cast<double>(std::strlen(robot_.name)), robot_.radius_m,
              robot_.wheel_radius_m, robot_.track_m, robot_.max_wheel_speed_rad_s,
              robot_.distance_bearing_rad[1] + robot_.distance_opening_rad[1], robot_.distance_max_m[1]}) {
          show(value);
        }
        break;
      case 7:
        show(r.compass_rad);
        break;
      case 8:
        show(static_cast<double>(r.channel_count));
        for (size_t i = 0; i < r.channel_count && i < 2; ++i) {
          show(r.channels[i].position);
          show(r.channels[i].velocity);
          show(std::isnan(r.channels[i].effort) ? -1 : r.channels[i].effort);
        }
        break;
      case 9:
        show(static_cast<double>(robot_.channel_count));
        for (size_t i = 0; i < robot_.channel_count && i < 2; ++i) {
          show(robot_.channels[i].module == std::string_view("motors"));
          show(robot_.channels[i].name == std::string_view(i == 0 ? "left" : "right"));
          show(robot_.channels[i].max_velocity);
        }
        show(robot_.channels[0].modes);
        break;
      case 10:
        for (const double value :
             {r.height_m, r.roll_rad, r.pitch_rad, r.velocity_m_s[0], r.velocity_m_s[1], r.velocity_m_s[2],
              r.angular_velocity_rad_s[0], r.angular_velocity_rad_s[1]}) {
          show(value);
        }
        break;
      default:
        for (const double value :
             {static_cast<double>(r.seed), static_cast<double>(r.step), r.time_s, r.step_s}) {
          show(value);
        }
    }
  }

 private:
  const coopdyn_robot& robot_;
  const int what_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Mirror>();
}
