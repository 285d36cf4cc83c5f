// SPDX-License-Identifier: MIT
#include "server/yars/wire.h"

#include <cmath>

#include "server/base/words.h"

namespace coopdyn {

YarsChannel YarsChannel::Of(const Message& reply) {
  constexpr std::size_t kEach = 6;
  YarsChannel channel;
  const std::vector<std::string> names = SplitWords(reply.text);
  const std::size_t motors = reply.params.empty() ? 0 : static_cast<std::size_t>(reply.params[0]);
  if (reply.params.size() > 3) channel.segments = reply.params[3];
  for (std::size_t i = 0; i < names.size() && (i + 1) * kEach <= reply.data.size(); ++i) {
    const double* const at = reply.data.data() + i * kEach;
    // YARS's number for a missing bound. Values without mapping are exchanged unchanged.
    constexpr double kUnbounded = 100'000;
    const double low = std::isfinite(at[0]) ? at[0] : -kUnbounded;
    const double high = std::isfinite(at[1]) ? at[1] : kUnbounded;
    const bool maps = std::isfinite(at[2]);
    (i < motors ? channel.motors : channel.values)
        .push_back({names[i], low, high, maps ? at[2] : low, maps ? at[3] : high, at[4] != 0,
                    static_cast<std::int32_t>(at[5])});
  }
  return channel;
}

}  // namespace coopdyn
