// SPDX-License-Identifier: MIT
// Noise of camera pixels: a function of the key (seed, camera, sample) and the pixel. Pure; any thread.
#pragma once

#include <span>

#include "server/model/sensor_models.h"
#include "server/render/picture.h"
#include "server/state/noise.h"

namespace coopdyn {

/// Adds `noise` to red, green and blue of each pixel; 1 is the full range.
void AddNoise(const ValueNoise& noise, const NoiseKey& key, Picture& picture);
/// Adds `noise`, m, to the depths that are neither 0 nor infinite.
void AddNoise(const ValueNoise& noise, const NoiseKey& key, std::span<float> depth_m);

}  // namespace coopdyn
