// SPDX-License-Identifier: MIT
#include "server/model/drive_train.h"

#include <algorithm>

namespace coopdyn {

PwmRow RowAt(const DriveTrainModel& train, double duty) {
  const auto next = std::ranges::find_if(train.pwm, [duty](const PwmRow& row) { return row.duty >= duty; });
  if (next == train.pwm.end()) return train.pwm.back();
  const PwmRow before = next == train.pwm.begin() ? PwmRow{0, 0, 0, 0} : *(next - 1);
  const double share = (duty - before.duty) / (next->duty - before.duty);
  const auto between = [share](double from, double to) { return from + share * (to - from); };
  return {duty, between(before.no_load_speed_rad_s, next->no_load_speed_rad_s),
          between(before.stall_torque_nm, next->stall_torque_nm),
          between(before.stall_current_a, next->stall_current_a)};
}

}  // namespace coopdyn
