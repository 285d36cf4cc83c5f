// SPDX-License-Identifier: MIT
// Sensor noise as a function of the reading's key, not of when or by whom it is read: reading twice gives the
// same value, and spectators change nothing. Pure; any thread.
#pragma once

#include <cstdint>

#include "server/model/sensor_models.h"

namespace coopdyn {

enum class NoiseKind : std::uint32_t {
  kDistance = 1,
  kTargetDistance,
  kTargetBearing,
  kRobotDistance,
  kRobotBearing,
  kNeighbourDistance,
  kNeighbourBearing,
  kMessageLoss,
  kCompass,
  kSupport,
  kEncoder,
  kImuTurn,
  kImuAcceleration,
  kImuOrientation,
  kWrench,
  kLidar,
  kSonar,
  kInfrared,
  kLight,
  kCameraColor,
  kCameraDepth,
  kSlip,
  kChannelValue,
  kChannelMotor
};

/// Identifies one reading. Readings that differ in any field have independent noise.
struct NoiseKey {
  std::uint64_t seed = 0;  // of the frame
  NoiseKind kind = NoiseKind::kDistance;
  std::uint32_t robot = 0;   // id of the robot that senses
  std::uint32_t sensor = 0;  // id of the sensor, or of the thing seen
  std::uint64_t step = 0;
  std::uint32_t sample = 0;  // index of a value within a reading; if `sensor` is a thing seen: the sensor
                             // that sees it
};

/// 64 well-mixed bits of `key`.
std::uint64_t NoiseBits(const NoiseKey& key);
/// A sample of the uniform distribution over (0, 1).
double UniformNoise(const NoiseKey& key);
/// A sample of the normal distribution with mean 0 and standard deviation 1; |value| < 9.
double GaussianNoise(const NoiseKey& key);

/// A sample of the uniform distribution over (-1, 1). Independent of the key's other two samples.
double CentredNoise(const NoiseKey& key);

/// `value` as a sensor with this noise reads it. The bias uses the key with step kBiasStep.
double Noisy(double value, const ValueNoise& noise, const NoiseKey& key);
inline constexpr std::uint64_t kBiasStep = ~std::uint64_t{0};

}  // namespace coopdyn
