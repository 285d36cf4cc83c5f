// SPDX-License-Identifier: MIT
// Broadcasts some sensors' readings for a test: the number of sensors, the first letter of the first one's
// type, the IMU's vertical acceleration, the step of its sample, the first and the last byte of the picture.
#include <cstring>

#include "clients/plugin/cpp_controller.h"

namespace {

class Feeler {
 public:
  struct State {
    char nothing;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_description description = {
        "shows what its sensors show", COOPDYN_SENSORS, sizeof(State), 0, nullptr, "left_eye imu"};
    return &description;
  }

  Feeler(const coopdyn_robot& robot, const double* /*options*/) : robot_(robot) {}
  void Reset(uint64_t /*seed*/) {}

  void Step(const coopdyn_readings& r, coopdyn_command& command) {
    const auto show = [&command](double value) { command.message[command.message_count++] = value; };
    show(static_cast<double>(robot_.sensor_count));
    for (size_t i = 0; i < robot_.sensor_count; ++i) {
      const coopdyn_sensor& sensor = robot_.sensors[i];
      const coopdyn_sensor_reading& reading = r.sensors[i];
      if (std::strcmp(sensor.type, "imu") == 0) {
        show(reading.values[sensor.value_count - 1]);
        show(static_cast<double>(reading.step));
      } else if (std::strcmp(sensor.module, "left_eye") == 0) {
        const size_t bytes = size_t{3} * sensor.width * sensor.height;
        show(reading.image[0]);
        show(reading.image[bytes - 1]);
      }
    }
  }

 private:
  const coopdyn_robot& robot_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Feeler>();
}
