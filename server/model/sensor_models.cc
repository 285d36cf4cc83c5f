// SPDX-License-Identifier: MIT
#include "server/model/sensor_models.h"

namespace coopdyn {

std::size_t FixedCount(const SensorKind& kind) {
  return std::visit(
      [](const auto& one) -> std::size_t {
        if constexpr (requires { one.kValues; }) return one.kValues.size();
        if constexpr (requires { one.values(); }) return one.values().count;
        if constexpr (requires { one.ValueNames(); }) return one.values.size();
        return 0;
      },
      kind);
}

std::vector<std::string> FixedNames(const SensorKind& kind) {
  return std::visit(
      [](const auto& one) -> std::vector<std::string> {
        if constexpr (requires { one.kValues; }) return {one.kValues.begin(), one.kValues.end()};
        if constexpr (requires { one.ValueNames(); }) return one.ValueNames();
        std::vector<std::string> names;
        if constexpr (requires { one.values(); }) {
          const auto [before, after, count] = one.values();
          for (std::size_t i = 1; i <= count; ++i) names.push_back(before + std::to_string(i) + after);
        }
        return names;
      },
      kind);
}

std::size_t MeasuredCount(const SensorKind& kind) {
  return std::visit(
      [](const auto& one) -> std::size_t {
        if constexpr (requires { one.measured(); }) return one.measured();
        return 0;
      },
      kind);
}

}  // namespace coopdyn
